//! Tests the estimator `two-pass` on surfaces whose curvature is given by a formula.

use approx::assert_relative_eq;
use nalgebra::{Point3, Vector3};
use palpate_sensing::{Channel, Stream};
use palpate_statistics::BadSetting;

use crate::{Contact, Ep2Error, Fit, Method, Passes, Patch, Status, TangentNormals, TwoPass};

/// A height field and its slopes.
type Surface = fn(f64, f64) -> (f64, [f64; 2]);

fn cylinder(x: f64, _: f64) -> (f64, [f64; 2]) {
    let z = (1e4 - x * x).sqrt();
    (z - 100.0, [-x / z, 0.0])
}

fn saddle(x: f64, y: f64) -> (f64, [f64; 2]) {
    (0.1 * (x * x - y * y), [0.2 * x, -0.2 * y])
}

/// Contacts of three fingers at y = −1.5, 0 and 1.5. Each finger has ten contacts with |x| ≤ 1.5.
fn contacts(surface: Surface, normals: bool) -> Vec<Contact> {
    let places = (0..3).flat_map(|finger| (0..10).map(move |step| (finger, step)));
    places
        .map(|(finger, step)| {
            let (x, y) = (-1.5 + step as f64 / 3.0, 1.5 * finger as f64 - 1.5);
            let (z, [p, q]) = surface(x, y);
            let normal = normals.then(|| Vector3::new(-p, -q, 1.0));
            Contact::new(finger, Point3::new(x, y, z), normal)
        })
        .collect()
}

/// First fit of the method `two-pass` to a saddle with Gaussian noise in its heights.
fn noisy(std: f64, trial: u64) -> Fit {
    let mut contacts = contacts(saddle, true);
    let mut noise = Stream::new(1, trial, Channel::Position);
    for contact in &mut contacts {
        contact.position.z += std * noise.standard_normal();
    }
    let method = TwoPass {
        unit_length: Some(1.0),
        passes: Passes::One,
        ..TwoPass::default()
    };
    method.fit(&patch(&contacts)).unwrap()
}

fn patch(contacts: &[Contact]) -> Patch {
    Patch::new(contacts, &Vector3::z()).unwrap()
}

/// Compares the estimated Gaussian curvature K and mean curvature H of the saddle at the points of a grid with
/// formulas.
fn assert_curvature(method: &TwoPass, normals: bool, bound: f64) {
    let fit = method.fit(&patch(&contacts(saddle, normals))).unwrap();
    for x in [-1.0, 0.0, 0.7] {
        for y in [-0.9, 0.0, 1.0] {
            let (z, [p, q]) = saddle(x, y);
            let found = fit.curvature_at(&Point3::new(x, y, z)).unwrap();
            let d = 1.0 + p * p + q * q;
            let trace = 0.2 * (1.0 + q * q) - 0.2 * (1.0 + p * p);
            let gaussian = -0.04 / (d * d);
            let mean = -trace / (2.0 * libm::pow(d, 1.5));
            assert!(
                (found.gaussian - gaussian).abs() <= bound * bound.max(gaussian.abs()),
                "{found:?} {gaussian}"
            );
            assert!(
                (found.mean - mean).abs() <= bound * mean.abs().max(0.1),
                "{found:?} {mean}"
            );
        }
    }
}

/// The first pass is exact. The second pass is not exact, because its points lie on the tangents. The distance of a
/// point from the surface is s² k / 2, where s is the step along the tangent and k the curvature; here it is 6e-4.
#[test]
fn a_saddle_is_fitted_by_a_biquadratic() {
    let first = TwoPass {
        passes: Passes::One,
        ..TwoPass::default()
    };
    assert_curvature(&first, true, 1e-9);
    let measured = TwoPass::default();
    let first_fit = TwoPass {
        normals: TangentNormals::FirstFit,
        ..measured
    };
    for (method, normals) in [(measured, true), (first_fit, true), (measured, false)] {
        assert_curvature(&method, normals, 1e-3);
    }
}

/// The smoothing sum of the paper is 1000 for 30 contacts of weight 100. A biquadratic spline without knots leaves 21
/// degrees of freedom. If the noise is 5 % of the unit of length, the expected residual sum is 525, so knots are not
/// needed. If the noise is 10 %, the expected sum is 2100, so knots are needed.
#[test]
fn the_noise_decides_the_number_of_knots() {
    let trials = 100;
    let plain = |std: f64| {
        (0..trials)
            .map(|trial| noisy(std, trial))
            .filter(|fit| fit.status == Some(Status::Polynomial))
            .inspect(|fit| assert_eq!(fit.spline.coefficients.len(), 9))
            .count()
    };
    assert!(plain(0.05) >= 96);
    assert!(plain(0.10) <= 6);
}

#[test]
fn the_default_unit_is_the_distance_between_fingers() {
    let contacts = contacts(saddle, true);
    let found = TwoPass::default().fit(&patch(&contacts)).unwrap();
    let given = TwoPass {
        unit_length: Some(1.5),
        ..TwoPass::default()
    };
    let given = given.fit(&patch(&contacts)).unwrap();
    for (one, other) in found
        .spline
        .coefficients
        .iter()
        .zip(&given.spline.coefficients)
    {
        assert_relative_eq!(*one, *other, epsilon = 1e-12);
    }
}

#[test]
fn invalid_settings_and_too_few_contacts_are_refused() {
    let default = TwoPass::default();
    let contacts = contacts(saddle, false);
    let whole = patch(&contacts);
    let name = |method: TwoPass, patch: &Patch| method.fit(patch).unwrap_err();
    let setting = |method: TwoPass| match name(method, &whole) {
        Ep2Error::BadSetting(BadSetting { setting, .. }) => setting,
        other => panic!("{other}"),
    };
    let with = |change: fn(&mut TwoPass)| {
        let mut method = default;
        change(&mut method);
        setting(method)
    };
    assert_eq!(with(|method| method.first_degree = 6), "first_degree");
    assert_eq!(with(|method| method.second_degree = 1), "second_degree");
    assert_eq!(with(|method| method.weight = 0.0), "weight");
    assert_eq!(with(|method| method.smoothing = -1.0), "smoothing");
    assert_eq!(
        with(|method| method.second_smoothing = f64::NAN),
        "second_smoothing"
    );
    assert_eq!(
        with(|method| method.tangent_step = f64::INFINITY),
        "tangent_step"
    );
    assert_eq!(with(|method| method.unit_length = Some(0.0)), "unit_length");
    let alone = |method: &mut TwoPass| {
        method.passes = Passes::One;
        method.first_degree = 1;
    };
    assert_eq!(with(alone), "first_degree");
    let few = patch(&contacts[8..16]);
    assert!(matches!(
        name(default, &few),
        Ep2Error::TooFewContacts {
            contacts: 8,
            needed: 9,
            ..
        }
    ));
    // A biquadratic surface needs contacts on at least three paths, but two fingers have only two paths.
    let two = patch(&self::contacts(cylinder, false)[..20]);
    assert!(matches!(
        name(default, &two),
        Ep2Error::Undetermined {
            rank: 6,
            unknowns: 9,
            ..
        }
    ));
    let one_finger: Vec<_> = contacts
        .iter()
        .map(|contact| Contact {
            finger: 0,
            ..*contact
        })
        .collect();
    assert!(matches!(
        name(default, &patch(&one_finger)),
        Ep2Error::BadSetting(BadSetting {
            setting: "unit_length",
            ..
        })
    ));
    let tiny = TwoPass {
        unit_length: Some(1e-200),
        ..default
    };
    assert_eq!(name(tiny, &whole), Ep2Error::OutOfRange);
}
