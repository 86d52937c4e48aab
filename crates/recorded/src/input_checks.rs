//! Likely mistakes of sign and unit, recognised by implausible readings.

mod normal_checks;

pub(super) use normal_checks::{of_directions, of_normals};

use std::f64::consts::TAU;

use palpate_ep1::{Estimate, ProbeReading, ReadingNoise, rounding_std};
use palpate_press::{ForwardFit, PressEstimate, Reading};
use palpate_statistics::Number;
use palpate_study::config::LengthUnit;

use super::press_recording::PressRecording;

/// Share of the largest displacement above which a displacement's sign counts, and share of these that must be
/// outward for a warning.
const SPEAKING: f64 = 0.2;
const NEARLY_ALL: f64 = 0.9;

/// Shares of the sensor's radius below which the extent of all markers, and the largest displacement, are likely in
/// another unit.
const TINY_EXTENT: f64 = 5e-3;
const TINY_DISPLACEMENT: f64 = 1e-4;

/// Limits of a probe's rotation relative to that on a plane, 1 + R_probe/R_object. Above `DEGREES` the rotations are
/// likely in degrees or the shifts in a larger unit; above `LARGER_UNIT` that unit is likely 1000 times as large.
/// Below `RADIANS` the rotations are likely in rad although the header says degrees; below `SMALLER_UNIT` the shifts
/// are in a smaller unit. Only a dish hardly wider than the probe gives so small a ratio.
const DEGREES: f64 = 25.0;
const LARGER_UNIT: f64 = 400.0;
const RADIANS: f64 = 1.0 / 30.0;
const SMALLER_UNIT: f64 = 1.0 / 300.0;

/// Lengths that the readings of a press are compared with.
#[derive(Clone, Copy)]
pub(super) struct Sensor {
    pub(super) radius: f64,
    pub(super) radial_scale: f64,
    /// Whether displacements are 0 without a press.
    pub(super) has_baseline: bool,
}

/// Likely mistake in the readings of a press.
pub(super) fn of_press(
    recorded: &PressRecording,
    sensor: Sensor,
    unit: LengthUnit,
) -> Option<String> {
    let Sensor { radius, .. } = sensor;
    let unit = unit.as_str();
    let places = recorded.places.iter();
    let extent =
        places.fold(0.0, |most: f64, [x, y]| most.max(libm::hypot(*x, *y))) * sensor.radial_scale;
    let moved = recorded.normal.iter();
    let largest = moved.fold(0.0, |most: f64, one| most.max(one.abs()));
    let [shown, moved, sensor_radius] = [extent, largest, radius].map(Number::rounded);
    if extent > std::f64::consts::PI * radius {
        return Some(format!(
            "a marker lies {shown} {unit} from the apex, beyond half the circumference of a sensor of radius {sensor_radius} {unit}: are both in one unit?"
        ));
    }
    if largest > radius {
        return Some(format!(
            "a marker is displaced by {moved} {unit}, more than the sensor's radius, {sensor_radius} {unit}: are both in one unit?"
        ));
    }
    if 0.0 < extent && extent < TINY_EXTENT * radius {
        return Some(format!(
            "all markers lie within {shown} {unit} of the apex of a sensor of radius {sensor_radius} {unit}: are the readings in m and the radius in mm?"
        ));
    }
    if 0.0 < largest && largest < TINY_DISPLACEMENT * radius {
        return Some(format!(
            "no marker is displaced by more than {moved} {unit}, on a sensor of radius {sensor_radius} {unit}: are the displacements in m and the rest in mm?"
        ));
    }
    let speaking = recorded
        .normal
        .iter()
        .filter(|one| one.abs() > SPEAKING * largest);
    let (outward, all) = speaking.fold((0.0, 0.0), |(outward, all), one| {
        (outward + f64::from(u8::from(*one < 0.0)), all + 1.0)
    });
    (sensor.has_baseline && all > 1.0 && outward >= NEARLY_ALL * all).then(|| {
        "the displacements point outward, but inward is positive: is the sign wrong?".to_owned()
    })
}

/// Least factor by which changed columns must reduce the sum of squares, and largest estimated noise along the skin
/// that is not suspicious, as a share of the largest displacement.
const FIT_BETTER: f64 = 4.0;
const NO_NOISE: f64 = 0.2;

/// Swap or change of sign of a displacement's components along the skin.
type Change = fn([f64; 2]) -> [f64; 2];

/// Likely mistake of signs or columns in the displacements along the skin, if the fit does not explain them.
pub(super) fn along_skin(
    fit: &ForwardFit,
    reading: &Reading<'_>,
    estimate: &PressEstimate,
    is_doubted: bool,
) -> Option<String> {
    let along = reading.tangential?;
    let own = estimate.tangential_std?;
    let most = along.iter().flatten();
    let most = most.fold(0.0, |most: f64, one| most.max(one.abs()));
    if !is_doubted && own <= NO_NOISE * most {
        return None;
    }
    let is_found = fit.tangential_std.is_none_or(|std| std <= 0.0);
    let misfit = |estimate: &PressEstimate| match is_found {
        true => estimate
            .tangential_std
            .map_or(f64::INFINITY, |std| std * std),
        false => estimate.reduced_chi_squared,
    };
    let changed = |change: Change| {
        let along: Vec<[f64; 2]> = along.iter().map(|along| change(*along)).collect();
        let changed = Reading {
            tangential: Some(&along),
            ..*reading
        };
        fit.estimate(&changed)
            .map_or(f64::INFINITY, |found| misfit(&found))
    };
    let changes: [(&str, Change); 4] = [
        ("tangential_x and tangential_y swapped", |[x, y]| [y, x]),
        ("the sign of tangential_x reversed", |[x, y]| [-x, y]),
        ("the sign of tangential_y reversed", |[x, y]| [x, -y]),
        ("both signs reversed", |[x, y]| [-x, -y]),
    ];
    let all = changes.map(|(name, change)| (name, changed(change)));
    let (name, least) = all
        .into_iter()
        .min_by(|(_, one), (_, other)| one.total_cmp(other))?;
    let ratio = misfit(estimate) / least;
    (ratio > FIT_BETTER && ratio.is_finite()).then(|| {
        let times = Number::rounded(ratio.sqrt());
        format!(
            "the displacements along the skin contradict those into it, which they would fit {times} times better with {name}: are columns swapped, or is a sign wrong?"
        )
    })
}

/// Likely mistake in the readings of a roll.
pub(super) fn of_roll(
    readings: &[ProbeReading],
    probe_radius: f64,
    unit: LengthUnit,
) -> Option<String> {
    let remedy = match unit {
        LengthUnit::M => " (setting `length_unit` mm, then)",
        _ => "",
    };
    let unit = unit.as_str();
    let most = readings
        .iter()
        .map(|reading| reading.rotation.norm())
        .fold(0.0, f64::max);
    if most == 0.0 {
        return Some("no probe turned: all rotations are 0".to_owned());
    }
    let turned = readings
        .iter()
        .filter(|reading| reading.shift.norm() > 0.0 && reading.rotation.norm() > 0.0);
    let mut ratios: Vec<f64> = turned
        .map(|reading| reading.rotation.norm() * probe_radius / reading.shift.norm())
        .collect();
    ratios.sort_by(f64::total_cmp);
    let ratio = ratios.get(ratios.len() / 2).copied();
    let times = |ratio: f64| Number::rounded(ratio);
    match ratio {
        Some(ratio) if ratio > LARGER_UNIT => Some(format!(
            "the probe turned {} times as far as on a plane: are the shifts in m and the radius in mm{}, or the rotations in mrad?",
            times(ratio),
            remedy
        )),
        Some(ratio) if ratio < SMALLER_UNIT => Some(format!(
            "the contact moved {} times as far as on a plane: are the shifts in a smaller unit than the radius?",
            times(ratio.recip())
        )),
        Some(ratio) if ratio < RADIANS => Some(format!(
            "the contact moved {} times as far as on a plane: are the rotations in rad, whatever the header says, or the shifts in a smaller unit than the radius?",
            times(ratio.recip())
        )),
        Some(ratio) if ratio > DEGREES => Some(format!(
            "the probe turned {} times as far as on a plane: are the rotations in degrees, or the shifts in cm and the radius in mm? the columns are in rad and {unit}",
            times(ratio)
        )),
        _ => (most > TAU).then(|| {
            format!(
                "a probe turned by {} rad, more than a whole turn: are the rotations in degrees? the columns are in rad",
                Number::rounded(most)
            )
        }),
    }
}

/// Warning if the stated noise of rotations exceeds every rotation.
pub(super) fn of_rotation_noise(
    readings: &[ProbeReading],
    stated: &ReadingNoise,
) -> Option<String> {
    let turns = readings.iter().map(|reading| reading.rotation.norm());
    let most = turns.fold(0.0, f64::max);
    let noise = stated.rotation_std_rad;
    (noise > most).then(|| {
        let [noise, most] = [noise, most].map(Number::rounded);
        format!(
            "the noise of rotations is stated as {noise} rad, but no probe turned by more than {most} rad: is it in degrees?"
        )
    })
}

/// Shares of the pitch. Pads report no shift below the first, since pads are hardly closer than 0.8 pitches; a shift
/// below the second is a rounded zero.
const NEAREST: f64 = 0.5;
const ROUNDING: f64 = 1e-9;

/// Warns of an object so flat that rounding of the readings affects its estimated curvature.
pub(super) fn of_flatness(
    estimate: &Estimate,
    probe_radius: f64,
    unit: LengthUnit,
) -> Option<String> {
    let principal = estimate.curvature.principal();
    let sharper = principal.k_min.abs().max(principal.k_max.abs());
    let std = rounding_std(probe_radius, sharper);
    // Warn if rounding exceeds a thousandth of the curvature.
    (sharper < 1e3 * std).then(|| {
        format!(
            "the object is too flat for readings of double precision: rounding alone errs by {} 1/{}, and the normal curvatures found are at most {}",
            Number::rounded(std), unit.as_str(), Number::rounded(sharper)
        )
    })
}

/// Warning of shifts that are shorter than pads of this resolution can report.
pub(super) fn of_pitch(
    readings: &[ProbeReading],
    resolution: f64,
    unit: LengthUnit,
) -> Option<String> {
    let shifts = readings.iter().map(|reading| reading.shift.norm());
    let moved = shifts.filter(|shift| *shift > ROUNDING * resolution);
    let shortest = moved.fold(f64::INFINITY, f64::min);
    (shortest < NEAREST * resolution && resolution.is_finite()).then(|| {
        let [shortest, resolution] = [shortest, resolution].map(Number::rounded);
        let unit = unit.as_str();
        format!(
            "a contact moved by {shortest} {unit}, less than from one pad to the next at a pitch of {resolution} {unit}: is the pitch right, and are the shifts in {unit}?"
        )
    })
}
