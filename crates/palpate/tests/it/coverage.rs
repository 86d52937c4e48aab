//! Tests that equal scenes have the same measured coverage, even if their configs describe them differently.

use palpate::{Coverage, Family, coverage};

#[track_caller]
fn family(text: &str) -> Result<&'static Family, String> {
    let study = palpate::parse("a-scene.toml", text).expect("a study");
    let config = study.cell(0).expect("a cell").config;
    match coverage(&config.scene, config.length_unit) {
        Coverage::Measured(family) => Ok(family),
        Coverage::Outside(_, why) | Coverage::NotMeasured(why) => Err(why),
    }
}

#[track_caller]
fn check(text: &str, name: &str, changes: &[(&str, &str)], others: &[(&str, &str, &str)]) {
    let expected = family(text).expect("a measured family");
    assert!(expected.name.starts_with(name), "{}", expected.name);
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        let other = family(&text.replace(from, to));
        assert_eq!(other, Ok(expected), "{to}");
    }
    for (from, to, why) in others {
        assert!(text.contains(from), "{from}");
        let other = family(&text.replace(from, to)).expect_err(to);
        assert_eq!(other, *why, "{to}");
    }
}

#[test]
fn rolls() {
    let text = r#"
name = "rolls"
length_unit = "mm"
[scene]
kind = "roll"
probe = { kind = "sphere", radius = 10.0 }
object = { kind = "sphere", radius = 40.0 }
motion = { angle_deg = 11.459155902616466, directions_deg = [0.0, 90.0, 180.0, 270.0] }
sensor = { kind = "wrist", std = 0.05 }
"#;
    let changes = [
        (
            "angle_deg = 11.459155902616466",
            "rate_rad_per_s = 0.1, duration_s = 2.0",
        ),
        ("angle_deg = 11.459155902616466", "arc_length = 1.6"),
        ("180.0, 270.0", "10.0, 80.0"),
    ];
    let others = [
        (
            "std = 0.05",
            "std = 0.2",
            "scene.sensor.std of 0.2 mm (they have 0.01 to 0.1 mm)",
        ),
        (
            "angle_deg = 11.459155902616466",
            "angle_deg = 10.0, spin_rad_per_s = 0.5, rate_rad_per_s = 1.0",
            "random scenes have no scene.motion.spin_rad_per_s of 0.5 (they have none)",
        ),
    ];
    check(text, "4 probes, balls, noise of shifts", &changes, &others);
}

#[test]
fn glides() {
    let text = r#"
name = "glides"
length_unit = "mm"
[scene]
kind = "glide"
probe = { kind = "point" }
object = { kind = "saddle", a = 0.1 }
motion = { finger_positions = [-1.5, 0.0, 1.5], inter_finger_distance = 1.5, patch_length = 3.0, contacts_per_finger = 10 }
sensor = { kind = "ideal", normals = false }
noise = { position = { kind = "gaussian", std = 0.015 } }
estimator = { kind = "penalised" }
evaluate = { half_width = 0.5, gaussian_threshold = 0.01, mean_threshold = 0.1 }
"#;
    let changes = [
        ("std = 0.015", "fraction_of_ifd = 0.01"),
        (
            r#""gaussian", std = 0.015"#,
            r#""uniform", bound = 0.025980762113533159"#,
        ),
        (
            r#"kind = "saddle", a = 0.1"#,
            r#"kind = "cylinder", radius = 5.0"#,
        ),
        (r#"kind = "point""#, r#"kind = "sphere", radius = 0.5"#),
    ];
    let others = [(
        r#"kind = "saddle", a = 0.1"#,
        r#"kind = "dish", radius = 1.0"#,
        "scene.object.curvature of 1 per mm (they have 0 to 0.5 per mm)",
    )];
    let name = "3 fingers, medium noise of positions, no normals, noise estimated, quadric";
    check(text, name, &changes, &others);
    let stated = text.replace(
        r#""penalised""#,
        r#""penalised", position_fraction_of_ifd = 0.01"#,
    );
    let name = "3 fingers, medium noise of positions, no normals, noise stated, quadric";
    check(&stated, name, &[], &[]);
}

#[test]
fn presses() {
    let text = r#"
name = "presses"
length_unit = "mm"
[scene]
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }
object = { kind = "plane" }
motion = { indentation = 1.0, contact_deg = [5.0, 70.0] }
noise = { normal_displacement = { kind = "gaussian", std = 0.05 }, indentation = { kind = "gaussian", std = 0.02 } }
sensor = { kind = "direct", tangential = false }
model = { kind = "half-space" }
estimator = { kind = "half-space", indentation = "known", indentation_std = 0.02 }
"#;
    let changes = [
        (r#"kind = "plane""#, r#"kind = "sphere", radius = 9.0"#),
        (r#"model = { kind = "half-space" }"#, ""),
        ("tangential = false", "tangential = false, frames = 4"),
        (
            "indentation_std = 0.02",
            "indentation_std = 0.02, poisson = 0.5",
        ),
    ];
    let others = [
        (
            "indentation_std = 0.02",
            "indentation_std = 0.03",
            "random scenes have no scene.estimator.indentation_std of 0.03 mm (they have none)",
        ),
        (
            r#"kind = "plane""#,
            r#"kind = "sphere", radius = 4.0"#,
            "scene.object.curvature of 0.25 per mm (they have -0.0165 to 0.2 per mm)",
        ),
        (
            r#"kind = "plane""#,
            r#"kind = "cylinder", radius = 20.0"#,
            "random scenes have no scene.object.kind of \"cylinder\" (they have \"ball\"); scene.object.radius of 20 mm (they have none)",
        ),
    ];
    let name = "half-space, indentation stated, normal displacements, noise stated";
    check(text, name, &changes, &others);
}
