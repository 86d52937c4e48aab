//! Mistakes of sign and unit, recognised by what the readings would otherwise mean.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use palpate_ep1::ProbeReading;
use palpate_ep2::Contact;
use palpate_number::Number;
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

/// Turns of a probe over those on a plane, 1 + R_probe/R_object: past the first the rotations are likely in degrees,
/// past the second the shifts in a larger unit, below the third in a smaller one.
const DEGREES: f64 = 25.0;
const LARGER_UNIT: f64 = 400.0;
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

/// The mistake that readings of a roll look like.
pub(super) fn of_roll(readings: &[ProbeReading], probe_radius: f64) -> Option<String> {
    let most = readings
        .iter()
        .map(|reading| reading.rotation.norm())
        .fold(0.0, f64::max);
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
            "the probe turned {} times as far as on a plane: are the shifts in m and the radius in mm?",
            times(ratio)
        )),
        Some(ratio) if ratio < SMALLER_UNIT => Some(format!(
            "the contact moved {} times as far as on a plane: are the shifts in a smaller unit than the radius?",
            times(ratio.recip())
        )),
        Some(ratio) if ratio > DEGREES => Some(format!(
            "the probe turned {} times as far as on a plane: are the rotations in degrees? the columns are in rad",
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

/// Length by which a normal may differ from 1, of rounding or of a sensor's noise in its components.
const LENGTH_OFF: f64 = 0.1;

/// Mistakes that the normals of contacts look like.
pub(super) fn of_normals(contacts: &[Contact]) -> impl Iterator<Item = String> {
    let normals = || contacts.iter().filter_map(|contact| contact.normal);
    let mut lengths: Vec<f64> = normals().map(|normal| normal.norm()).collect();
    lengths.sort_by(f64::total_cmp);
    let middle = lengths.get(lengths.len() / 2).copied();
    let length = middle.filter(|length| (length - 1.0).abs() > LENGTH_OFF);
    let length = length.map(|length| {
        format!(
            "the normals have lengths of about {}, not 1: are they unit vectors, and no angles?",
            Number::rounded(length)
        )
    });
    let mean: Vector3<f64> = normals()
        .filter_map(|normal| normal.try_normalize(0.0))
        .sum();
    let is_down = mean.z < -0.5 * contacts.len() as f64;
    let inward = is_down.then(|| {
        "the normals point to -z, out of an object that is touched from below: do they point inward? then convex and concave are swapped".to_owned()
    });
    length.into_iter().chain(inward)
}
