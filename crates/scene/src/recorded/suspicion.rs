//! Mistakes of sign and unit, recognised by what the readings would otherwise mean.

mod normals;

pub(super) use normals::{of_directions, of_normals};

use std::f64::consts::TAU;

use palpate_chance::GoodnessOfFit;
use palpate_ep1::{Estimate, ProbeReading, ReadingNoise, rounding_std};
use palpate_number::Number;
use palpate_press::{ForwardFit, PressEstimate, Reading};
use palpate_study::config::LengthUnit;

use super::press::PressReadings;

/// Share of the largest displacement from which on a displacement has a sign to speak of, and share of the markers
/// with such that have it all.
const SPEAKING: f64 = 0.2;
const NEARLY_ALL: f64 = 0.9;

/// Shares of the sensor's radius below which the extent of all markers, and the largest displacement, are lengths of
/// another unit: half of what a thousandth makes of a tenth.
const TINY_EXTENT: f64 = 5e-3;
const TINY_DISPLACEMENT: f64 = 1e-4;

/// Turns of a probe over those on a plane, 1 + R_probe/R_object: past the first the rotations are likely in degrees or the
/// shifts in a larger unit, past the second the shifts in one that is a thousand times as large. Below the third the
/// rotations are likely in radians under a header that says degrees, below the fourth the shifts in a smaller unit; only in
/// a dish hardly wider than the probe would it turn as little.
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

/// The mistake that readings of a press look like.
pub(super) fn of_press(
    recorded: &PressReadings,
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
        "the displacements point outward, and positive is inward: is the sign wrong?".to_owned()
    })
}

/// Ratio of sums of squares from which on displacements along the skin fit better with their columns changed, and share of the
/// largest of them past which noise that is found is none.
const FIT_BETTER: f64 = 4.0;
const NO_NOISE: f64 = 0.2;

/// Change of a displacement along the skin.
type Change = fn([f64; 2]) -> [f64; 2];

/// The mistake of signs or columns that displacements along the skin look like, where the fit does not follow them.
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
        ("the sign of tangential_x turned", |[x, y]| [-x, y]),
        ("the sign of tangential_y turned", |[x, y]| [x, -y]),
        ("both signs turned", |[x, y]| [-x, -y]),
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

/// The mistake that readings of a roll look like.
pub(super) fn of_roll(
    readings: &[ProbeReading],
    probe_radius: f64,
    unit: LengthUnit,
) -> Option<String> {
    let remedy = match unit {
        LengthUnit::M => " (--length-unit mm, then)",
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

/// Probability of residuals of rolls as small by chance, below which they are too small for the noise that is stated.
const TOO_SMALL: f64 = 3e-5;

/// Ratio of the stated noise to the residuals from which on the one is far too large.
const FAR_TOO_LARGE: f64 = 4.0;

/// The warning of noise of rotations that is stated larger than any of them.
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

/// The warning of residuals of rolls that are far smaller than the noise of shifts that is stated. Errors of pads are no
/// noise: they may all be the same, or none at all.
pub(super) fn of_small_residuals(
    residual: f64,
    goodness: GoodnessOfFit,
    stated: &ReadingNoise,
    unit: LengthUnit,
) -> Option<String> {
    let noise = stated.shift_std;
    if noise <= 0.0 || stated.shift_resolution > 0.0 {
        return None;
    }
    let share = residual / noise;
    (1.0 - goodness.p_value < TOO_SMALL && goodness.freedom > 0 && share * FAR_TOO_LARGE < 1.0).then(|| {
        let [noise, residual] = [noise, residual].map(Number::rounded);
        let unit = unit.as_str();
        format!(
            "the noise of shifts is stated as {noise} {unit}, but they contradict each other by {residual} {unit} only: standard deviations are too large, or the shifts are in a larger unit than {unit}"
        )
    })
}

/// Share of the pitch below which pads report no shift: neighbours on a fingertip are hardly nearer than 0.8 of it. A shift
/// below the second share is rounding of none.
const NEAREST: f64 = 0.5;
const ROUNDING: f64 = 1e-9;

/// The warning of an object so flat that rounding of the readings is a part of its curvature.
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

/// The warning of shifts that are shorter than pads of this resolution report any.
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
