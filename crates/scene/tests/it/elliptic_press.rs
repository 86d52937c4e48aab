//! Presses on cylinders and ellipsoids, and the forces of presses.

use palpate_scene::Trials;
use palpate_study::config::LengthUnit;

use super::press::{BALL, NOISE, PLANE, numbers, outcomes, press, refused, scene_of, text};

const ELLIPTIC: &str = "estimator = { kind = \"elliptic\", indentation_std = 0.02 }\n";

pub(super) fn cylinder(radius: f64, direction_deg: f64) -> String {
    format!("{{ kind = \"cylinder\", radius = {radius:?}, direction_deg = {direction_deg:?} }}")
}

pub(super) fn ellipsoid(semi_axes: [f64; 3]) -> String {
    format!("{{ kind = \"ellipsoid\", semi_axes = {semi_axes:?} }}")
}

#[test]
fn without_noise_both_curvatures_and_the_axis_are_found() {
    for (object, larger, smaller, axis) in [
        (cylinder(10.0, 30.0), 0.1, 0.0, 30.0),
        (cylinder(40.0, 260.0), 0.025, 0.0, 80.0),
        // At the top of an ellipsoid with the semi-axes x, y and z, the principal curvatures are z/x² and z/y².
        (ellipsoid([20.0, 10.0, 16.0]), 0.16, 0.04, 0.0),
        (ellipsoid([10.0, 20.0, 16.0]), 0.16, 0.04, 90.0),
    ] {
        for contact in ["", ", contact_deg = [12, 200]"] {
            let text = text(&object, ELLIPTIC)
                .replace("indentation = 1.0", &format!("indentation = 1.0{contact}"));
            let scene = scene_of(&text);
            let outcomes = outcomes(&scene, 0).unwrap();
            let mean = 0.5 * (larger + smaller);
            for (name, truth) in [
                ("object_curvature", mean),
                ("relative_curvature", 0.05 + mean),
                ("principal_curvature_max", larger),
                ("principal_curvature_min", smaller),
            ] {
                let (_, outcome) = outcomes.iter().find(|(known, _)| *known == name).unwrap();
                assert!((outcome.truth - truth).abs() <= 1e-15, "{name} {outcome:?}");
                assert!(
                    (outcome.estimate - truth).abs() < 1e-5,
                    "{name} {outcome:?}"
                );
            }
            let (name, outcome) = outcomes.last().unwrap();
            assert_eq!(
                (*name, scene.quantities().len()),
                ("axis_deg", outcomes.len())
            );
            assert!((outcome.truth.abs() - axis).abs() < 1e-12, "{outcome:?}");
            assert!(
                (outcome.estimate - outcome.truth).abs() < 1e-3,
                "{outcome:?}"
            );
        }
    }
}

#[test]
fn a_press_on_a_cylinder_has_the_golden_displacements() {
    let line = r#"layout = { kind = "line", markers = 3, length = 4.0 } }"#;
    let text = text(&cylinder(8.0, 0.0), "").replace(
        "marker_depth = 2.0 }",
        &format!("marker_depth = 2.0, {line}"),
    );
    let trace = press(&text).trace(None, LengthUnit::Mm).unwrap();
    let rows = numbers(&trace.contacts);
    // These values are in the first row of the table press/tests/it/elliptic-half-space.csv.
    assert!((rows[1][4] - 0.78384711507).abs() < 1e-9, "{rows:?}");
    assert!(rows[1][5].abs() < 1e-9 && rows[1][6].abs() < 1e-9);
    let radius = (4.89968578679_f64 * 2.13762746926).sqrt();
    let scene = scene_of(&text);
    assert!((scene.truth(4).unwrap() - radius).abs() < 1e-9);
}

#[test]
fn an_ellipsoid_of_equal_axes_is_a_ball() {
    let both = [BALL.to_owned(), ellipsoid([80.0; 3])].map(|object| {
        let layer = "model = { kind = \"bonded-layer\", thickness = 8.0 }\n";
        outcomes(&scene_of(&text(&object, &format!("{NOISE}{layer}"))), 3).unwrap()
    });
    assert_eq!(both[0], both[1]);
    // The two curvatures of a ball are equal, so there is no axis of the smaller curvature.
    let scene = scene_of(&text(BALL, &format!("{NOISE}{ELLIPTIC}")));
    let names: Vec<&str> = scene.quantities().iter().map(|one| one.name).collect();
    let ends = [
        "object_radius",
        "principal_curvature_max",
        "principal_curvature_min",
    ];
    assert!(names.ends_with(&ends), "{names:?}");
    let (place, outcomes) = (names.len() - 1, outcomes(&scene, 0).unwrap());
    assert_eq!(
        [scene.truth(place), scene.truth(place - 1)],
        [Some(1.0 / 80.0); 2]
    );
    assert_eq!(
        [scene.std_bound(place), scene.std_bound(place - 1)],
        [None; 2]
    );
    for (_, outcome) in &outcomes[7..] {
        assert!(outcome.interval_holds.unwrap()[2], "{outcome:?}");
    }
}

#[test]
fn the_force_is_in_newtons() {
    // Young's modulus is 600 kPa and Poisson's ratio is 0.5, so E* is 800 kPa. The unit kPa mm² is equal to mN.
    let force = |object: &str, model: &str, estimator: &str, unit: &str| {
        let lines = format!("model = {{ {model}, modulus_kpa = 600 }}\n{estimator}");
        let lines = text(object, &lines).replace("seed = 3", &format!("length_unit = \"{unit}\""));
        let scene = scene_of(&lines);
        let place = scene.quantities().len() - 1;
        let quantity = scene.quantities()[place];
        assert_eq!(
            (quantity.name, quantity.unit),
            ("force", palpate_study::Unit::Newton)
        );
        let truth = scene.truth(place).unwrap();
        let outcomes = outcomes(&scene, 0).unwrap();
        let (name, outcome) = outcomes.last().unwrap();
        assert_eq!((*name, outcome.truth), ("force", truth));
        assert!((outcome.estimate / truth - 1.0).abs() < 1e-4, "{outcome:?}");
        truth
    };
    let half_space = "kind = \"half-space\"";
    // The force is 4/3 E* √R δ^(3/2), with the effective radius R = 16 and the indentation δ = 1. If the unit is m
    // instead of mm, all lengths are 1000 times as large, and the force is 10⁶ times as large.
    let closed = 4.0 / 3.0 * 800.0 * 4.0 * 1e-3;
    for (unit, factor) in [("mm", 1.0), ("m", 1e6), ("um", 1e-6)] {
        let force = force(BALL, half_space, "", unit);
        assert!(
            (force / (factor * closed) - 1.0).abs() < 1e-12,
            "{unit} {force}"
        );
    }
    // The force is 2/3 π a b p₀, with the semi-axes a and b and the peak pressure p₀. These three values are in the
    // table press/tests/it/elliptic-half-space.csv.
    let golden = 2.0 / 3.0 * std::f64::consts::PI * 4.89968578679 * 2.13762746926;
    let golden = golden * 0.205202786617 * 0.8;
    let ellipse = force(&cylinder(8.0, 0.0), half_space, ELLIPTIC, "mm");
    assert!((ellipse / golden - 1.0).abs() < 1e-9, "{ellipse}");
    // A layer that is thick compared with the contact is nearly a half-space.
    let layer = force(
        BALL,
        "kind = \"bonded-layer\", thickness = 19.9",
        "estimator = { kind = \"bonded-layer\" }\n",
        "mm",
    );
    assert!(layer > closed && layer < 1.5 * closed, "{layer}");
    let without_unit = text(PLANE, "model = { kind = \"hertz\", modulus_kpa = 9.0 }");
    let message = "scene.model.modulus_kpa: a force needs a unit of lengths: set `length_unit`, or leave out the modulus";
    assert_eq!(refused(&without_unit), message);
}

#[test]
fn both_curvatures_and_the_axis_reach_their_bounds() {
    let noise = NOISE.replace("0.07", "0.02");
    // The direction of the axis, 89°, is near the end of its range, so some estimates are beyond 90° and are reported
    // near −90°.
    let text = text(&cylinder(10.0, 89.0), &format!("{noise}{ELLIPTIC}"));
    let scene = scene_of(&text.replace("indentation = 1.0 }", "indentation = 2.0 }"));
    let (trials, names) = (
        60,
        [
            "principal_curvature_max",
            "principal_curvature_min",
            "axis_deg",
        ],
    );
    let (mut squares, mut held) = ([0.0; 3], [0; 3]);
    for trial in 0..trials {
        let outcomes = outcomes(&scene, trial).unwrap();
        for (index, name) in names.into_iter().enumerate() {
            let (_, outcome) = outcomes.iter().find(|(known, _)| *known == name).unwrap();
            squares[index] += (outcome.estimate - outcome.truth).powi(2);
            held[index] += u32::from(outcome.interval_holds.unwrap()[2]);
        }
    }
    for (index, name) in names.into_iter().enumerate() {
        let rms = (squares[index] / trials as f64).sqrt();
        let place = scene.quantities().iter().position(|one| one.name == name);
        let bound = scene.std_bound(place.unwrap()).unwrap();
        assert!(
            rms > 0.75 * bound && rms < 1.3 * bound,
            "{name}: {rms} {bound}"
        );
        assert!(held[index] >= 52, "{name}: {held:?}");
    }
    // The estimator `half-space` fits a single curvature, which cannot describe a press on a cylinder. Therefore its
    // estimates have no Cramér–Rao bound.
    let round = "estimator = { kind = \"half-space\" }\n";
    let scene = scene_of(&self::text(
        &cylinder(10.0, 0.0),
        &format!("{noise}{round}"),
    ));
    assert_eq!(scene.std_bound(0), None);
}
