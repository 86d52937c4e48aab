//! Tests the methods with random contacts. If the contacts determine a surface, the methods fit it. If the contacts
//! contain arbitrary doubles, the result is finite or the expected error. Neither the unit of length nor the
//! orientation changes the result.

use nalgebra::{Matrix3, Point3, Rotation3, Vector3};
use palpate_ep2::{
    Contact, Curvature, Ep2Error, Fit, MapPoint, Method, Noise, Patch, Penalised, Quadric, TwoPass,
    Uncertainty, regions,
};
use palpate_geometry::{ShapeClass, ShapeThresholds};
use proptest::prelude::*;

/// Random doubles: a sixth with any bit pattern, two thirds between −2 and 2, a sixth between 1e-9 and 1e9.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => any::<u64>().prop_map(f64::from_bits),
        4 => -2.0..2.0,
        1 => (-9.0..9.0).prop_map(|power: f64| libm::pow(10f64, power)),
    ]
}

fn vector() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(any_number()).prop_map(Vector3::from)
}

/// Contacts of a rough patch, with or without normals. With a probability of 40 %, the numbers of one contact are
/// arbitrary doubles.
fn contacts() -> impl Strategy<Value = Vec<Contact>> {
    let part = || -2.0..2.0;
    let contact = (
        0..4_usize,
        [part(), part(), part()],
        [part(), part()],
        1e-3..10.0,
    );
    let wild = (
        any::<prop::sample::Index>(),
        vector(),
        prop::option::of(vector()),
        any_number(),
    );
    let all = (
        prop::collection::vec(contact, 0..30),
        any::<bool>(),
        prop::option::weighted(0.4, wild),
    );
    all.prop_map(|(contacts, has_normals, spoilt)| {
        let contact = |(finger, place, [x, y], weight): (usize, [f64; 3], [f64; 2], f64)| Contact {
            finger,
            position: Point3::from(place),
            normal: has_normals.then(|| Vector3::new(0.2 * x, 0.2 * y, 1.0)),
            weight,
        };
        let mut contacts: Vec<Contact> = contacts.into_iter().map(contact).collect();
        if let Some((index, place, normal, weight)) = spoilt.filter(|_| !contacts.is_empty()) {
            let at = index.index(contacts.len());
            contacts[at] = Contact {
                position: Point3::from(place),
                normal,
                weight,
                ..contacts[at]
            };
        }
        contacts
    })
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn methods(number: f64) -> [Box<dyn Method>; 4] {
    let noise = Noise {
        position_std: Some(number),
        normal_std_rad: None,
    };
    let two_pass = TwoPass {
        smoothing: number,
        tangent_step: number.abs().clamp(1e-9, 1.0),
        ..TwoPass::default()
    };
    [
        Box::new(Quadric { noise }),
        Box::new(Quadric::default()),
        Box::new(Penalised::default()),
        Box::new(two_pass),
    ]
}

/// Largest contradiction between the numbers of a map point. The Gaussian and the mean curvature must follow from the
/// principal curvatures, and the axes must be orthonormal.
fn inconsistency(point: &MapPoint) -> f64 {
    let (least, most) = (point.k_min, point.k_max);
    let scale = least.abs().max(most.abs()).max(f64::MIN_POSITIVE);
    let [least, most] = [least / scale, most / scale];
    let axes =
        Matrix3::from_columns(&[point.normal, point.direction_of_min, point.direction_of_max]);
    let off = axes.transpose() * axes - Matrix3::identity();
    let gaussian = point.curvature.gaussian / scale / scale - least * most;
    let mean = point.curvature.mean / scale - 0.5 * (least + most);
    off.amax().max(gaussian.abs()).max(mean.abs())
}

fn is_finite(point: &MapPoint) -> bool {
    let curvature = point.curvature;
    let uncertainty = curvature.uncertainty.map_or([0.0; 3], |one| {
        [one.gaussian_std, one.mean_std, one.correlation]
    });
    let numbers = [curvature.gaussian, curvature.mean, point.k_min, point.k_max];
    let places = point
        .position
        .iter()
        .chain(&point.normal)
        .chain(&point.direction_of_max);
    let mut all = numbers.iter().chain(&uncertainty).chain(places);
    all.all(|number| number.is_finite())
}

fn bump() -> Vec<Contact> {
    let at = |index: usize| [index % 7, index / 7].map(|step| step as f64 / 3.0 - 1.0);
    let contact = |index: usize| {
        let [x, y] = at(index);
        let z = 0.3 * libm::exp(-(x * x + y * y));
        let normal = Vector3::new(2.0 * x * z, 2.0 * y * z, 1.0);
        Contact::new(index / 7, Point3::new(x, y, z), Some(normal))
    };
    (0..49).map(contact).collect()
}

#[test]
fn maps_have_regions_unless_their_size_is_wrong() {
    let fit = Quadric::default()
        .fit(&Patch::new(&bump(), &Vector3::z()).unwrap())
        .unwrap();
    let name = |error: Ep2Error| <&str>::from(error);
    assert_eq!(fit.map(usize::MAX).map_err(name).err(), Some("bad-setting"));
    assert_eq!(
        fit.curvatures(1 << 20).map_err(name).err(),
        Some("bad-setting")
    );
    assert_eq!([0, 1].map(|side| fit.map(side).unwrap().len()), [0, 1]);
    let mut points = fit.map(3).unwrap();
    let thresholds = ShapeThresholds::new(1e-3, 1e-3).unwrap();
    for side in [0, 2, usize::MAX] {
        let refused = regions(side, &points, &thresholds).map_err(name).err();
        assert_eq!(refused, Some("bad-setting"));
    }
    // A ridge divides a plane into two regions.
    for (index, point) in points.iter_mut().enumerate() {
        point.curvature.gaussian = 0.0;
        point.curvature.mean = if index / 3 == 1 { 0.2 } else { 0.0 };
    }
    let found = regions(3, &points, &thresholds).unwrap();
    assert_eq!([found.regions.len(), found.regions[0].points], [3, 3]);
    let ridge = &found.regions[found.of_point[4]];
    assert_eq!(ridge.class, ShapeClass::Ridge);
    assert!((ridge.mean_curvature - 0.2).abs() < 1e-12);
    points[4].k_max = f64::NAN;
    assert_eq!(
        regions(3, &points, &thresholds).map_err(name).err(),
        Some("out-of-range")
    );
}

/// If the standard errors of the curvatures are smaller than rounding errors, one shape class has the probability 1. If
/// numbers overflow, no probabilities are returned.
#[test]
fn uncertainties_of_any_size_return_probabilities_or_none() {
    let thresholds = ShapeThresholds::new(0.01, 0.1).unwrap();
    let of = |std: f64, correlation: f64| {
        let uncertainty = Some(Uncertainty {
            gaussian_std: std,
            mean_std: std,
            correlation,
        });
        Curvature {
            gaussian: 1.0,
            mean: 1.0,
            uncertainty,
        }
        .class_probabilities(&thresholds)
    };
    for std in [f64::from_bits(1), 1e-300, 1e-17] {
        assert_eq!(
            of(std, 0.5).unwrap().iter().copied().fold(0.0, f64::max),
            1.0
        );
    }
    for correlation in [-1.0, 0.0, 1.0] {
        for std in [0.0, 1e-9, 1.0, 1e9, 1e100] {
            let sum: f64 = of(std, correlation).unwrap().iter().sum();
            assert!((sum - 1.0).abs() < 1e-12, "{std:e}, {correlation}: {sum}");
        }
    }
    assert_eq!((of(f64::MAX, 0.5), of(f64::NAN, 0.5)), (None, None));
    assert_eq!(of(1.0, f64::NAN), None);
}

/// Name of the error that must be returned for these contacts. `None` if no number is invalid, so that only the fit can
/// find an error.
fn expected_error(contacts: &[Contact], outward: &Vector3<f64>) -> Option<&'static str> {
    if contacts.len() < 3 {
        return Some("too-few-contacts");
    }
    let have_normals = contacts.iter().any(|contact| contact.normal.is_some());
    let flaw = |contact: &Contact| {
        let normal = contact.normal.unwrap_or(Vector3::zeros());
        let largest = contact.position.coords.abs().sum() + normal.abs().sum();
        if !(largest <= 1e150 && contact.weight <= 1e150) {
            Some("not-finite")
        } else if contact.weight <= 0.0 {
            Some("bad-weight")
        } else if have_normals && contact.normal.is_none() {
            Some("missing-normal")
        } else {
            (have_normals && normal.amax() < 1e-150).then_some("bad-normal")
        }
    };
    let is_direction = outward.amax() > 0.0 && outward.iter().all(|part| part.abs() <= 1e150);
    contacts
        .iter()
        .find_map(flaw)
        .or((!is_direction).then_some("bad-setting"))
}

proptest! {
    #![proptest_config(config(200))]

    #[test]
    fn bumps_of_any_size_have_a_curvature_everywhere(
        power in -9.0..9.0_f64,
        moves in prop::collection::vec(prop::array::uniform3(-0.01..0.01), 49),
        (has_normals, number) in (any::<bool>(), 1e-3..1.0),
    ) {
        let size = libm::pow(10.0, power);
        let contacts: Vec<Contact> = bump().into_iter().zip(&moves).map(|(contact, moved)| Contact {
            position: (contact.position + Vector3::from(*moved)) * size,
            normal: contact.normal.filter(|_| has_normals),
            ..contact
        }).collect();
        let patch = Patch::new(&contacts, &Vector3::z()).unwrap();
        for method in methods(number) {
            let fit = method.fit(&patch).unwrap();
            prop_assert!(fit.effective_unknowns.is_finite());
            let map = fit.map(4).unwrap();
            prop_assert_eq!(map.len(), 16);
            for (found, point) in fit.curvatures(4).unwrap().iter().zip(&map) {
                prop_assert!(is_finite(point), "{point:?}");
                prop_assert!(inconsistency(point) < 1e-7, "{} {point:?}", inconsistency(point));
                let scale = point.k_min.abs().max(point.k_max.abs());
                let mean = (found.mean - point.curvature.mean) / scale;
                let gaussian = (found.gaussian - point.curvature.gaussian) / scale / scale;
                prop_assert!(mean.abs().max(gaussian.abs()) < 1e-9, "{found:?} {point:?}");
            }
            prop_assert!(is_finite(&fit.points_at(&[contacts[24].position]).unwrap()[0]));
        }
    }

    #[test]
    fn any_contacts_return_numbers_or_the_expected_error(
        contacts in contacts(),
        outward in prop_oneof![3 => Just(Vector3::z()), 1 => vector()],
        place in vector(),
        number in any_number(),
    ) {
        let patch = Patch::new(&contacts, &outward);
        if let Some(expected_error) = expected_error(&contacts, &outward) {
            prop_assert_eq!(<&str>::from(patch.unwrap_err()), expected_error);
            return Ok(());
        }
        let Ok(patch) = patch else { return Ok(()) };
        let fits = methods(number).map(|method| method.fit(&patch));
        let [noisy, .., two_pass] = &fits;
        let refused = |fit: &Result<Fit, Ep2Error>| fit.as_ref().err().map(<&str>::from);
        if !(number > 0.0 && number.is_finite()) {
            prop_assert_eq!(refused(noisy), Some("bad-setting"));
        }
        if number.is_nan() || number < 0.0 {
            prop_assert_eq!(refused(two_pass), Some("bad-setting"));
        }
        for fit in fits.into_iter().flatten() {
            prop_assert!(fit.effective_unknowns.is_finite());
            for point in fit.points_at(&[Point3::from(place)]).into_iter().chain(fit.map(4)).flatten() {
                prop_assert!(is_finite(&point), "{point:?}");
            }
        }
    }
}

proptest! {
    #![proptest_config(config(24))]

    #[test]
    fn scaled_and_turned_patches_have_scaled_curvatures(
        power in -200..200,
        angles in prop::array::uniform3(-3.0..3.0),
        away in -5.0..5.0,
        (has_normals, place) in (any::<bool>(), prop::array::uniform2(-0.8..0.8)),
    ) {
        let (scale, turn) = (2f64.powi(power), Rotation3::from_euler_angles(angles[0], angles[1], angles[2]));
        let moved = |place: Point3<f64>| Point3::from(turn * (place.coords * scale) + Vector3::repeat(away * scale));
        let still: Vec<Contact> = bump().into_iter().map(|contact| Contact {
            normal: contact.normal.filter(|_| has_normals),
            ..contact
        }).collect();
        let turned: Vec<Contact> = still.iter().map(|contact| Contact {
            position: moved(contact.position),
            normal: contact.normal.map(|normal| turn * normal),
            ..*contact
        }).collect();
        let place = Point3::new(place[0], place[1], 0.2);
        let methods: [&dyn Method; 3] = [&Quadric::default(), &Penalised::default(), &TwoPass::default()];
        for method in methods {
            let at = |contacts: &[Contact], outward, place| {
                let fit = method.fit(&Patch::new(contacts, &outward).unwrap()).unwrap();
                fit.curvature_at(&place).unwrap()
            };
            let one = at(&still, Vector3::z(), place);
            let other = at(&turned, turn * Vector3::z(), moved(place));
            prop_assert!((one.mean - other.mean * scale).abs() < 1e-8, "{one:?} {other:?}");
            prop_assert!((one.gaussian - other.gaussian * scale * scale).abs() < 1e-7, "{one:?} {other:?}");
        }
    }

    /// The paraboloid w = (b₁ u² + b₂ v²)/2 has the Gaussian curvature b₁ b₂ and the mean curvature −(b₁ + b₂)/2 at its
    /// apex.
    #[test]
    fn paraboloids_are_estimated_exactly(
        power in -100.0..100.0_f64,
        (bend, share) in (-12.0..0.0_f64, -1.0..1.0_f64),
        offset in prop_oneof![Just(0.0), (0.0..9.0_f64).prop_map(|power| libm::pow(10.0, power))],
        angles in prop::array::uniform3(-3.0..3.0),
    ) {
        let (size, bend) = (libm::pow(10.0, power), libm::pow(10.0, bend));
        let other = bend * share;
        let turn = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let contact = |index: usize| {
            let [u, v] = [index % 9, index / 9].map(|step| step as f64 / 4.0 - 1.0);
            let place = Vector3::new(u, v, 0.5 * (bend * u * u + other * v * v));
            let normal = turn * Vector3::new(-bend * u, -other * v, 1.0);
            Contact::new(index / 9, Point3::from((turn * place).add_scalar(offset) * size), Some(normal))
        };
        let contacts: Vec<Contact> = (0..81).map(contact).collect();
        let patch = Patch::new(&contacts, &(turn * Vector3::z())).unwrap();
        // Rounding errors of positions cause a false curvature. Therefore the bound on the relative error of the
        // curvature includes these rounding errors.
        let bound = 1e-11 + 1e3 * f64::EPSILON * (1.0 + offset) / bend;
        let methods: [&dyn Method; 2] = [&Quadric::default(), &Penalised::default()];
        for method in methods {
            let apex = Point3::from(Vector3::repeat(offset * size));
            let found = method.fit(&patch).unwrap().curvature_at(&apex).unwrap();
            let (mean, gaussian) = (found.mean * size / bend, found.gaussian * size / bend * (size / bend));
            prop_assert!((mean + 0.5 * (1.0 + share)).abs() <= bound, "{found:?}");
            prop_assert!((gaussian - share).abs() <= bound * (1.0 + bound), "{found:?}");
        }
    }
}
