//! Tests the cells of sweeps, and errors that are caused by the values or paths of a sweep.

use super::{edited, study};
use palpate_study::config::{FieldError, ObjectConfig, SceneConfig, Study, parse};

fn coordinates(study: &Study) -> Vec<Vec<String>> {
    study.cells().map(|cell| cell.coordinates).collect()
}

fn objects(study: &Study) -> Vec<ObjectConfig> {
    fn object(scene: SceneConfig) -> ObjectConfig {
        match scene {
            SceneConfig::Roll(roll) => roll.object,
            SceneConfig::Glide(glide) => glide.object,
            SceneConfig::Press(_) | SceneConfig::Fingertip(_) => panic!("no object of a surface"),
        }
    }
    study
        .cells()
        .map(|cell| object(cell.config.scene))
        .collect()
}

#[test]
fn no_sweep_is_one_cell() {
    let study = study("");
    assert_eq!(study.cell_count(), 1);
    assert!(study.cell(1).is_err());
    assert!(study.columns.is_empty() && study.cell(0).unwrap().coordinates.is_empty());
    assert_eq!(study.cell(0).unwrap().config, study.config);
}

#[test]
fn axes_multiply_and_the_first_is_slowest() {
    let study = study(
        r#"
        [[sweep]]
        path = "scene.object.radius"
        values = [500, 5.0, 0.5]
        [[sweep]]
        path = "scene.motion.rate_rad_per_s"
        values = [0.1, 1e-9]"#,
    );
    assert_eq!(
        study.columns,
        ["scene.object.radius_cm", "scene.motion.rate_rad_per_s"]
    );
    assert_eq!(
        coordinates(&study),
        [
            ["500", "0.1"],
            ["500", "1e-9"],
            ["5", "0.1"],
            ["5", "1e-9"],
            ["0.5", "0.1"],
            ["0.5", "1e-9"]
        ]
    );
    assert_eq!(objects(&study)[3], ObjectConfig::Sphere { radius: 5.0 });
}

#[test]
fn rows_move_together_and_labels_stand_for_tables() {
    let study = study(
        r#"
        [[sweep]]
        paths = ["scene.object", "seed"]
        values = [
            [{ label = "turned cylinder", kind = "cylinder", radius = 5, direction_deg = 45 }, 7],
            [{ label = "flat, wide", kind = "plane" }, 8],
        ]"#,
    );
    assert_eq!(study.columns, ["scene.object", "seed"]);
    assert_eq!(
        coordinates(&study),
        [["turned cylinder", "7"], ["flat, wide", "8"]]
    );
    let cylinder = ObjectConfig::Cylinder {
        radius: 5.0,
        direction_deg: 45.0,
    };
    assert_eq!(objects(&study), [cylinder, ObjectConfig::Plane {}]);
    assert_eq!(study.cell(1).unwrap().config.seed, 8);
}

#[test]
fn paths_reach_array_items_parameters_and_absent_options() {
    let text = edited(
        r#"{ kind = "sphere", radius = 5.0 }"#,
        r#"{ kind = "height-field", formula = "k*x", parameters = { k = 1 } }"#,
    );
    let sweep = r#"
        [[sweep]]
        path = "scene.object.parameters.k"
        values = [0.5]
        [[sweep]]
        path = "scene.object_contact"
        values = [[0, 0.25]]
        [[sweep]]
        path = "scene.object_contact.0"
        values = [3]"#;
    let study = parse("study.toml", &(text + sweep)).unwrap();
    assert_eq!(
        study.columns,
        [
            "scene.object.parameters.k",
            "scene.object_contact_cm",
            "scene.object_contact.0_cm"
        ]
    );
    assert_eq!(coordinates(&study), [["0.5", "[0, 0.25]", "3"]]);
    let SceneConfig::Roll(roll) = &study.cell(0).unwrap().config.scene else {
        panic!("not a roll");
    };
    assert_eq!(roll.object_contact, Some([3.0, 0.25]));
    assert!(
        matches!(&roll.object, ObjectConfig::HeightField { parameters, .. } if parameters["k"] == 0.5)
    );
}

#[test]
fn the_base_may_lack_what_a_sweep_sets() {
    let text = edited(
        "object = { kind = \"sphere\", radius = 5.0 }\n",
        "object = { kind = \"paraboloid\" }\n",
    );
    let sweep = "[[sweep]]\npath = \"scene.object.c\"\nvalues = [5, -0.01]";
    let study = parse("study.toml", &(text + sweep)).unwrap();
    assert_eq!(study.columns, ["scene.object.c_per_cm"]);
    assert_eq!(objects(&study)[1], ObjectConfig::Paraboloid { c: -0.01 });
}

fn shown(path: &str, range: &str) -> Vec<String> {
    coordinates(&study(&format!("[[sweep]]\npath = \"{path}\"\n{range}"))).concat()
}

#[test]
fn ranges_keep_their_ends_and_round_between() {
    let radii = |from: &str, to: &str, count: usize, spacing: &str| {
        let range = format!("from = {from}\nto = {to}\ncount = {count}\nspacing = \"{spacing}\"");
        shown("scene.object.radius", &range).join(" ")
    };
    assert_eq!(radii("0.01", "100", 5, "log"), "0.01 0.1 1 10 100");
    assert_eq!(radii("0.1", "0.5", 5, "linear"), "0.1 0.2 0.3 0.4 0.5");
    assert_eq!(radii("1e-300", "1e300", 3, "log"), "1e-300 1 1e300");
    assert_eq!(
        radii("1e-308", "1.7e308", 3, "linear"),
        "1e-308 8.5e307 1.7e308"
    );
    assert_eq!(radii("2", "1", 3, "linear"), "2 1.5 1");
    assert_eq!(radii("2", "2.0", 1, "linear"), "2");
    assert_eq!(
        shown("trials", "from = 100.0\nto = 300\ncount = 3"),
        ["100", "200", "300"]
    );
}

#[test]
fn later_errors_point_at_the_value_of_the_cell_or_the_nearest_parent() {
    let swept = study("[[sweep]]\npath = \"scene.object.radius\"\nvalues = [4, 3]\n");
    let plain = study("");
    for (error, place) in [
        (
            swept.error_at(1, FieldError::at("scene.object.radius", "small")),
            "11:14: scene.object.radius: small\n",
        ),
        (
            plain.error_at(0, FieldError::at("scene.sensor.pitch", "large")),
            "4:1: scene.sensor.pitch: large\n",
        ),
        (
            plain.error_at(
                0,
                FieldError {
                    part: Some(2..4),
                    ..FieldError::at("scene.object.kind", "odd")
                },
            ),
            "7:22: scene.object.kind: odd\n",
        ),
    ] {
        let shown = error.to_string();
        assert!(shown.starts_with(&format!("study.toml:{place}")), "{shown}");
        assert_eq!(
            shown.contains("in cell 1: scene.object.radius = 3"),
            error.message == "small"
        );
    }
}

#[test]
fn overrides_reach_every_cell_and_are_checked() {
    let mut study = study("[[sweep]]\npath = \"trials\"\nvalues = [4, 3]\n");
    study.override_numbers(Some(42), None).unwrap();
    assert!(study.cells().all(|cell| cell.config.seed == 42));
    assert_eq!(study.config.seed, 42);
    assert_eq!(
        study
            .override_numbers(Some(u64::MAX), None)
            .unwrap_err()
            .path,
        "seed"
    );
    assert_eq!(
        study.override_numbers(None, Some(7)).unwrap_err().path,
        "trials"
    );
    let mut plain = super::study("");
    plain.override_numbers(None, Some(7)).unwrap();
    assert_eq!(plain.cell(0).unwrap().config.trials, 7);
    assert_eq!(
        plain.override_numbers(None, Some(0)).unwrap_err().path,
        "trials"
    );
}
