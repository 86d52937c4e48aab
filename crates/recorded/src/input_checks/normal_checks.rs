//! Likely mistakes of sign and column in the normals of contacts.

use nalgebra::{Matrix3, Vector3};
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

/// Fewest contacts for which signs and columns of the normals are checked.
const MIN_CONTACTS: usize = 8;

/// Least ratio by which changed components must reduce the errors of contacts and normals.
const MIN_RATIO: f64 = 2.0;

/// Largest error of a fit that explains the contacts and their normals.
const MAX_ERROR: f64 = 0.1;

/// Likely mistake of signs or columns in the normals: a quadric through the contacts fits them much better with other
/// components.
pub(crate) fn of_directions(contacts: &[Contact]) -> Option<String> {
    let has_normals = contacts.iter().all(|contact| contact.normal.is_some());
    if !has_normals || contacts.len() < MIN_CONTACTS {
        return None;
    }
    let own = fit_error(contacts, &Matrix3::identity());
    let changed = changes().map(|(change, name)| (fit_error(contacts, &change), name));
    let (least, name) = changed
        .into_iter()
        .min_by(|(one, _), (other, _)| one.total_cmp(other))?;
    (own > MIN_RATIO * least && least < MAX_ERROR).then(|| {
        let times = match (own / least).is_finite() {
            true => format!("{} times ", Number::rounded(own / least)),
            false => String::new(),
        };
        format!(
            "the normals contradict the places of the contacts, which they would fit {times}better with {name}: are columns swapped, or is a sign wrong?"
        )
    })
}

/// Geometric mean of the errors of a contact's height and both slopes about a quadric, with changed normals; infinite without a
/// quadric.
fn fit_error(contacts: &[Contact], change: &Matrix3<f64>) -> f64 {
    let changed = contacts.iter().map(|contact| Contact {
        normal: contact.normal.map(|normal| change * normal),
        ..*contact
    });
    let patch = Patch::new(&changed.collect::<Vec<_>>(), &Vector3::z());
    let fit = patch.and_then(|patch| Quadric::default().fit(&patch));
    let noise = fit
        .ok()
        .and_then(|fit| Some((fit.frame.scale(), fit.noise?)));
    let error = noise.and_then(|(scale, noise)| {
        let slope = noise.normal_std_rad?;
        Some(libm::cbrt(noise.position_std / scale * slope * slope))
    });
    error.unwrap_or(f64::INFINITY)
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
    use nalgebra::Point3;
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
}
