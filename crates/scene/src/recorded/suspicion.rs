//! Mistakes of sign and unit, recognised by what the readings would otherwise mean.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, Matrix3, Point3, RowDVector, Vector3};
use palpate_chance::GoodnessOfFit;
use palpate_ep1::{ProbeReading, ReadingNoise};
use palpate_ep2::{Contact, Method, Patch, Quadric};
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

/// Fewest contacts whose normals are held against the shape that their places tell.
const FEWEST: usize = 8;

/// Ratio of sums of squares from which on normals fit the places better with their components changed: they differ from
/// those of the fit by three times as much as they are.
const FIT_BETTER: f64 = 9.0;

/// Spread of places across the curve that they lie along, over how far they stand off the surface through them, from which on
/// they tell normals: about a curve alone any surface may turn.
const SPREADS: f64 = 10.0;

/// Spread across that files of few digits may make, as a share of the spread along.
const ROUNDED: f64 = 1e-6;

/// The root-mean-square spread of places across the parabola that they lie along most, in the plane that they lie in most;
/// 0 where rounding hides it.
fn spread_across(places: &[Point3<f64>]) -> f64 {
    let count = places.len() as f64;
    let sum: Vector3<f64> = places.iter().map(|place| place.coords).sum();
    let arms: Vec<Vector3<f64>> = places
        .iter()
        .map(|place| place.coords - sum / count)
        .collect();
    let size = arms.iter().fold(0.0, |most: f64, arm| most.max(arm.amax()));
    if !(size > 0.0 && size.is_finite()) {
        return 0.0;
    }
    let arms: Vec<Vector3<f64>> = arms.iter().map(|arm| arm / size).collect();
    let spread: Matrix3<f64> = arms.iter().map(|arm| arm * arm.transpose()).sum();
    let eigen = spread.symmetric_eigen();
    let mut axes = [0, 1, 2];
    axes.sort_by(|&one, &other| eigen.eigenvalues[other].total_cmp(&eigen.eigenvalues[one]));
    let [along, across, _] = axes.map(|axis| eigen.eigenvectors.column(axis));
    let parabola = DMatrix::from_fn(arms.len(), 3, |row, power| {
        let along = along.dot(&arms[row]);
        [1.0, along, along * along][power]
    });
    let across = DVector::from_fn(arms.len(), |row, _| across.dot(&arms[row]));
    let fitted = parabola.clone().svd(true, true).solve(&across, 1e-12);
    let left = fitted.map_or(0.0, |fitted| (across - parabola * fitted).norm());
    match left > ROUNDED * eigen.eigenvalues[axes[0]].sqrt() {
        true => size * left / count.sqrt(),
        false => 0.0,
    }
}

/// Least ratio of the squares by which normals are off to those of the slopes' own errors, for the places to tell normals:
/// across two lines any surface may turn.
const TELLS_NORMALS: f64 = 9.0;

/// Least singular value of places that determine a quadric, as a share of the largest.
const DETERMINED: f64 = 1e-9;

/// Mean square of the errors of the slopes that a quadric through the places of a patch has, where these stand off it by
/// `off`; infinite where they leave it open.
fn slope_errors(patch: &Patch, off: f64) -> f64 {
    let samples = &patch.samples;
    let heights = DMatrix::from_fn(samples.len(), 6, |row, column| {
        let (u, v) = (samples[row].u, samples[row].v);
        [1.0, u, v, u * u, u * v, v * v][column]
    });
    let svd = heights.svd(false, true);
    let Some(directions) = svd.v_t else {
        return f64::INFINITY;
    };
    let largest = svd.singular_values.max();
    let square = |along: &RowDVector<f64>| -> f64 {
        let parts = directions.row_iter().zip(&svd.singular_values);
        parts
            .map(|(direction, size)| match *size > DETERMINED * largest {
                true => libm::pow(direction.dot(along) * off / size, 2.0),
                false => f64::INFINITY,
            })
            .sum()
    };
    let errors = samples.iter().map(|sample| {
        let (u, v) = (sample.u, sample.v);
        let rows = [
            [0.0, 1.0, 0.0, 2.0 * u, v, 0.0],
            [0.0, 0.0, 1.0, 0.0, u, 2.0 * v],
        ];
        let rows = rows.map(|row| square(&RowDVector::from_row_slice(&row)));
        rows.iter().sum::<f64>()
    });
    errors.sum::<f64>() / samples.len() as f64
}

/// The mistake of signs or columns that the normals of contacts look like, held against a quadric through their places alone.
pub(super) fn of_directions(contacts: &[Contact]) -> Option<String> {
    let normals: Option<Vec<Vector3<f64>>> = contacts
        .iter()
        .map(|contact| contact.normal?.try_normalize(0.0))
        .collect();
    let normals = normals.filter(|normals| normals.len() >= FEWEST)?;
    let bare: Vec<Contact> = contacts
        .iter()
        .map(|contact| Contact::new(contact.finger, contact.position, None))
        .collect();
    let places: Vec<Point3<f64>> = contacts.iter().map(|contact| contact.position).collect();
    // Whichever side is outside: both are compared.
    let sides = [Vector3::z(), Vector3::x(), Vector3::y()];
    let patch = sides.iter().find_map(|side| Patch::new(&bare, side).ok())?;
    let fit = Quadric::default().fit(&patch).ok()?;
    let off = fit.noise.map_or(0.0, |noise| noise.position_std);
    if spread_across(&places) <= SPREADS * off {
        return None;
    }
    let errors = slope_errors(&patch, off / patch.frame.scale());
    let shown: Vec<Vector3<f64>> = fit
        .points_at(&places)
        .ok()?
        .iter()
        .map(|point| point.normal)
        .collect();
    let off = |change: &Matrix3<f64>| -> f64 {
        let pairs = normals.iter().zip(&shown);
        let squares = |sign: f64| -> f64 {
            let pairs = pairs.clone();
            pairs
                .map(|(normal, shown)| (change * normal * sign - shown).norm_squared())
                .sum()
        };
        squares(1.0).min(squares(-1.0))
    };
    let mut best = (f64::INFINITY, "");
    for (change, name) in changes() {
        let off = off(&change);
        if off < best.0 {
            best = (off, name);
        }
    }
    let (least, name) = best;
    let own = off(&Matrix3::identity());
    let is_told = own > TELLS_NORMALS * errors * normals.len() as f64;
    (own > FIT_BETTER * least && is_told && own.is_finite()).then(|| {
        let times = match least > 0.0 {
            true => format!("{} times ", Number::rounded((own / least).sqrt())),
            false => String::new(),
        };
        format!(
            "the normals contradict the places of the contacts, which they would fit {times}better with {name}: are columns swapped, or is a sign wrong?"
        )
    })
}

/// Mistakes that swap two components or turn the sign of one, whichever side is outside.
fn changes() -> [(Matrix3<f64>, &'static str); 6] {
    let signs = |x, y, z| Matrix3::from_diagonal(&Vector3::new(x, y, z));
    let swap = |one: usize, other: usize| {
        let mut change = Matrix3::identity();
        change.swap_columns(one, other);
        change
    };
    [
        (signs(-1.0, 1.0, 1.0), "the sign of normal_x turned"),
        (signs(1.0, -1.0, 1.0), "the sign of normal_y turned"),
        (signs(1.0, 1.0, -1.0), "the sign of normal_z turned"),
        (swap(0, 1), "normal_x and normal_y swapped"),
        (swap(0, 2), "normal_x and normal_z swapped"),
        (swap(1, 2), "normal_y and normal_z swapped"),
    ]
}

#[cfg(test)]
mod tests {
    use palpate_sensing::{Channel, Stream};

    use super::*;

    /// Contacts with their normals on a ball of 30 mm, on lines so far apart, with noise of 0.02 mm and 1 degree.
    fn on_a_ball(apart: f64, seen: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Vec<Contact> {
        let mut stream = Stream::new(1996, 0, Channel::Position);
        let mut noise = |std: f64| Vector3::from_fn(|_, _| std * stream.standard_normal());
        let contacts = (0..63).map(|number| {
            let [x, y] = [
                f64::from(number % 21) - 10.0,
                apart * f64::from(number / 21),
            ];
            let normal = Vector3::new(x, y, (900.0 - x * x - y * y).sqrt()) / 30.0;
            let place = Point3::from(normal * 30.0 + noise(0.02));
            let normal = seen((normal + noise(0.017)).normalize());
            Contact::new(number as usize / 21, place, Some(normal))
        });
        contacts.collect()
    }

    #[test]
    fn swapped_normals_are_told_by_a_patch_and_not_by_a_line() {
        let swapped = |normal: Vector3<f64>| Vector3::new(normal.x, normal.z, normal.y);
        for apart in [1.0, 4.0] {
            assert_eq!(of_directions(&on_a_ball(apart, |normal| normal)), None);
            let told = of_directions(&on_a_ball(apart, swapped)).unwrap();
            assert!(told.contains("normal_y and normal_z swapped"), "{told}");
        }
        // The plane that an arc lies in is none that its normals stand on.
        assert_eq!(of_directions(&on_a_ball(0.0, |normal| normal)), None);
    }

    #[test]
    fn two_lines_tell_no_normals_across() {
        let told = |line: usize| {
            let on_lines = on_a_ball(4.0, |normal| normal);
            let two = on_lines.into_iter().filter(|one| one.finger != line);
            of_directions(&two.collect::<Vec<_>>())
        };
        assert_eq!([0, 1, 2].map(told), [None, None, None]);
    }

    #[test]
    fn places_of_any_size_spread_as_they_do() {
        let grid = |size: f64| -> Vec<Point3<f64>> {
            let place =
                |number: u32| Point3::new(f64::from(number % 5), f64::from(number / 5), 0.0);
            (0..15).map(|number| place(number) * size).collect()
        };
        let one = spread_across(&grid(1.0));
        // Of rows at 0, 1 and 2.
        assert!((one - (2.0_f64 / 3.0).sqrt()).abs() < 1e-12, "{one}");
        for size in [1e-200, 1e-3, 1e150] {
            assert!((spread_across(&grid(size)) / size / one - 1.0).abs() < 1e-9);
        }
        assert_eq!(spread_across(&grid(0.0)), 0.0);
    }
}
