//! Contacts that do not determine a patch return a named error or a finite result.

use nalgebra::{Point3, Vector3};
use palpate_ep2::{
    Contact, Criterion, Ep2Error, Method, Noise, Patch, Penalised, Quadric, TwoPass,
};
use palpate_statistics::BadSetting;

use crate::samples::{QUADRIC_LIKE, Sweep};

fn methods() -> [Box<dyn Method>; 3] {
    [
        Box::new(Penalised::default()),
        Box::new(Quadric::default()),
        Box::new(TwoPass::default()),
    ]
}

/// The outcome of each method: "result" if it computes all curvatures, otherwise the name of its first error.
fn outcomes(contacts: &[Contact]) -> [&'static str; 3] {
    methods().map(|method| {
        let outcome = Patch::new(contacts, &Vector3::z())
            .and_then(|patch| method.fit(&patch))
            .and_then(|fit| Ok((fit.centre()?, fit.curvatures(7)?)));
        match outcome {
            Ok((centre, curvatures)) => {
                for one in curvatures.iter().chain([&centre.curvature]) {
                    assert!(one.gaussian.is_finite() && one.mean.is_finite(), "{one:?}");
                }
                "result"
            }
            Err(error) => {
                assert!(!error.to_string().contains("NaN"), "{error}");
                error.into()
            }
        }
    })
}

fn plain(points: impl IntoIterator<Item = [f64; 3]>) -> Vec<Contact> {
    points
        .into_iter()
        .map(|point| Contact::new(0, Point3::from(point), None))
        .collect()
}

fn sphere() -> Vec<Contact> {
    Sweep::paper(0.01).contacts(&QUADRIC_LIKE[0], 0)
}

#[test]
fn points_lines_and_curves_are_refused() {
    let point = plain(std::iter::repeat_n([3.0, -1.0, 2.0], 1000));
    assert_eq!(outcomes(&point), ["coincident"; 3]);
    let line = plain((0..40).map(|step| [0.1 * f64::from(step), 0.2 * f64::from(step), 1.0]));
    assert_eq!(outcomes(&line), ["collinear"; 3]);
    // A patch whose width is below a millionth of its length counts as a line.
    for (share, is_line) in [(1e-13, true), (1e-7, true), (1e-5, false)] {
        let wide = 19.0 * share;
        let nearly = (0..20).map(|step| [f64::from(step), wide * f64::from(step % 3), 0.0]);
        let is_refused = outcomes(&plain(nearly)).map(|outcome| outcome == "collinear");
        assert_eq!(is_refused, [is_line; 3], "{share:e}");
    }
    // The contacts of one finger form a curve in a plane. They do not determine the shape across this curve.
    let curve = (0..40).map(|step| {
        let x = 0.1 * f64::from(step);
        [x, 0.0, -0.1 * x * x]
    });
    for outcome in outcomes(&plain(curve)) {
        assert_ne!(outcome, "result");
    }
}

#[test]
fn invalid_and_folded_normals_are_refused() {
    let changed = |normal: Option<Vector3<f64>>| {
        let mut contacts = sphere();
        contacts[4].normal = normal;
        outcomes(&contacts)
    };
    assert_eq!(changed(Some(Vector3::zeros())), ["bad-normal"; 3]);
    assert_eq!(changed(None), ["missing-normal"; 3]);
    assert_eq!(changed(Some(Vector3::x())), ["folded"; 3]);
    assert_eq!(changed(Some(-Vector3::z())), ["folded"; 3]);
}

#[test]
fn closed_shapes_are_refused_and_walls_need_an_outward_direction() {
    let directions: Vec<Vector3<f64>> = (0..200)
        .map(|index| {
            // The contacts form a spiral over the whole sphere.
            let (height, turn) = (1.0 - (index as f64 + 0.5) / 100.0, 2.4 * index as f64);
            let out = (1.0 - height * height).sqrt();
            Vector3::new(out * libm::cos(turn), out * libm::sin(turn), height)
        })
        .collect();
    let bare: Vec<Contact> = directions
        .iter()
        .map(|direction| Contact::new(0, Point3::from(direction * 3.0), None))
        .collect();
    assert_eq!(outcomes(&bare), ["no-plane"; 3]);
    let with_normals: Vec<Contact> = directions
        .iter()
        .map(|direction| Contact::new(0, Point3::from(direction * 3.0), Some(*direction)))
        .collect();
    assert_eq!(outcomes(&with_normals), ["no-plane"; 3]);
    // A vertical wall is a valid patch if the outward direction is stated.
    let wall: Vec<Contact> = sphere()
        .iter()
        .map(|contact| Contact {
            position: Point3::new(contact.position.z, contact.position.x, contact.position.y),
            normal: contact.normal.map(|n| Vector3::new(n.z, n.x, n.y)),
            ..*contact
        })
        .collect();
    assert_eq!(outcomes(&wall), ["result"; 3]);
    // If a wall is vertical, the outward direction "up" does not determine which side of the wall is outside. If the
    // wall is inclined, it does.
    let bare_wall = |lean: f64| {
        plain((0..36).map(|index| {
            let (y, z) = (f64::from(index % 6), f64::from(index / 6));
            [lean * z, y, z]
        }))
    };
    assert_eq!(outcomes(&bare_wall(0.0)), ["no-side"; 3]);
    assert_eq!(outcomes(&bare_wall(0.01)), ["no-side"; 3]);
    assert_eq!(outcomes(&bare_wall(0.1))[..2], ["result"; 2]);
}

#[test]
fn settings_out_of_range_are_refused() {
    let patch = Patch::new(&sphere(), &Vector3::z()).unwrap();
    let refused = |method: &dyn Method| match method.fit(&patch).unwrap_err() {
        Ep2Error::BadSetting(BadSetting { setting, .. }) => setting,
        other => panic!("{other}"),
    };
    let penalised = Penalised::default();
    for intervals in [0, 25].map(Some) {
        let method = Penalised {
            intervals,
            ..penalised
        };
        assert_eq!(refused(&method), "intervals");
    }
    for gamma in [0.5, 101.0, f64::NAN] {
        let method = Penalised {
            criterion: Criterion::RobustGcv { gamma },
            ..penalised
        };
        assert_eq!(refused(&method), "gamma");
    }
    let outcome = |std: f64, is_quadric: bool| {
        let noise = Noise {
            position_std: Some(std),
            normal_std_rad: Some(std),
        };
        let found = if is_quadric {
            Quadric { noise }.fit(&patch)
        } else {
            Penalised { noise, ..penalised }.fit(&patch)
        };
        found
            .and_then(|fit| fit.centre())
            .map_or_else(<&str>::from, |_| "result")
    };
    for is_quadric in [true, false] {
        for (std, expected) in [
            (f64::NAN, "bad-setting"),
            (0.0, "bad-setting"),
            (f64::from_bits(1), "result"),
            (1e12, "result"),
            (f64::MAX, "out-of-range"),
        ] {
            assert_eq!(outcome(std, is_quadric), expected, "{std:e}, {is_quadric}");
        }
    }
}

#[test]
fn positions_beyond_the_range_of_doubles_are_refused() {
    let patch = Patch::new(&sphere(), &Vector3::z()).unwrap();
    for method in methods() {
        let fit = method.fit(&patch).unwrap();
        assert!(fit.points_at(&[Point3::new(1e3, 1e3, 0.0)]).is_ok());
        for far in [1e50, f64::MAX, f64::NAN] {
            let error = fit.points_at(&[Point3::new(far, far, 0.0)]).unwrap_err();
            assert_eq!(error, Ep2Error::OutOfRange);
        }
    }
}

#[test]
fn a_weight_far_above_all_others_makes_the_fit_undetermined() {
    for (weight, expected) in [
        (1e-300, "result"),
        (1e6, "result"),
        (1e15, "undetermined"),
        (1e149, "undetermined"),
    ] {
        let mut contacts = sphere();
        contacts[3].weight = weight;
        assert_eq!(outcomes(&contacts), [expected; 3], "{weight:e}");
    }
}
