//! Likely mistakes of sign and column in the normals of contacts.

use nalgebra::{DMatrix, DVector, Matrix3, Point3, RowDVector, Vector3};
use palpate_ep2::{Contact, Method, Patch, Quadric};
use palpate_statistics::Number;

use palpate_study::Warning;

/// Largest deviation of a normal's length from 1 by rounding or by noise in its components.
const LENGTH_OFF: f64 = 0.1;

/// Likely mistakes in the normals of contacts.
pub(crate) fn of_normals(contacts: &[Contact]) -> impl Iterator<Item = Warning> {
    let normals = || contacts.iter().filter_map(|contact| contact.normal);
    let mut lengths: Vec<f64> = normals().map(|normal| normal.norm()).collect();
    lengths.sort_by(f64::total_cmp);
    let middle = lengths.get(lengths.len() / 2).copied();
    let length = middle.filter(|length| (length - 1.0).abs() > LENGTH_OFF);
    let length = length.map(|length| {
        format!(
            "the normals have lengths of about {}, not 1: are they angles instead of unit vectors?",
            Number::rounded(length)
        )
    });
    let mean: Vector3<f64> = normals()
        .filter_map(|normal| normal.try_normalize(0.0))
        .sum();
    let is_down = mean.z < -0.5 * contacts.len() as f64;
    let inward = is_down.then(|| {
        "the normals point to -z: unless the object is touched from below, they point inward, and convex and concave are swapped".to_owned()
    });
    let length = Warning::of("units", length);
    length.into_iter().chain(Warning::of("signs", inward))
}

/// Fewest contacts for comparing the normals with a surface through the places.
const FEWEST: usize = 8;

/// Least factor by which changed components must reduce the sum of squared errors of the normals: errors three times
/// smaller.
const FIT_BETTER: f64 = 9.0;

/// Least spread of the places across their main curve, relative to their noise, for the comparison of normals: a
/// single curve does not fix the tilt of the surface about it.
const SPREADS: f64 = 10.0;

/// Spread across that rounding in a file may cause, as a share of the spread along.
const ROUNDED: f64 = 1e-6;

/// Root-mean-square spread of the places across their best-fit parabola, in their best-fit plane; 0 if rounding may
/// cause it.
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

/// Least ratio of the normals' squared errors to those of the fitted slopes, for the comparison of normals: two lines
/// do not fix the slope across them.
const TELLS_NORMALS: f64 = 9.0;

/// Least singular value for which places determine a quadric, as a share of the largest.
const DETERMINED: f64 = 1e-9;

/// Mean square error of the slopes of a quadric through the places of a patch, if their noise is `off`; infinite if
/// they do not determine it.
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

/// Likely mistake of signs or columns in the normals, by comparison with a quadric through the places alone.
pub(crate) fn of_directions(contacts: &[Contact]) -> Option<String> {
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
    // Any outward side will do, because both signs of the normals are compared.
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

/// Mistakes that swap two components or reverse the sign of one, up to a common sign.
fn changes() -> [(Matrix3<f64>, &'static str); 6] {
    let signs = |x, y, z| Matrix3::from_diagonal(&Vector3::new(x, y, z));
    let swap = |one: usize, other: usize| {
        let mut change = Matrix3::identity();
        change.swap_columns(one, other);
        change
    };
    [
        (signs(-1.0, 1.0, 1.0), "the sign of normal_x reversed"),
        (signs(1.0, -1.0, 1.0), "the sign of normal_y reversed"),
        (signs(1.0, 1.0, -1.0), "the sign of normal_z reversed"),
        (swap(0, 1), "normal_x and normal_y swapped"),
        (swap(0, 2), "normal_x and normal_z swapped"),
        (swap(1, 2), "normal_y and normal_z swapped"),
    ]
}

#[cfg(test)]
mod tests {
    use palpate_sensing::{Channel, Stream};

    use super::*;

    /// Contacts with normals on a ball of radius 30 mm, on lines `apart` mm apart; noise 0.02 mm and 1 degree.
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
        // A single arc does not determine a surface, so its normals are not compared.
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
        // Rows at 0, 1 and 2 have a variance of 2/3.
        assert!((one - (2.0_f64 / 3.0).sqrt()).abs() < 1e-12, "{one}");
        for size in [1e-200, 1e-3, 1e150] {
            assert!((spread_across(&grid(size)) / size / one - 1.0).abs() < 1e-9);
        }
        assert_eq!(spread_across(&grid(0.0)), 0.0);
    }
}
