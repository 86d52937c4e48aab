//! The cells that sweeps make, and errors that point into them.

use super::{BASE, edited, study};
use palpate_study::config::{ObjectConfig, SceneConfig, Study, parse};

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
    assert_eq!(
        study.cell(1).unwrap_err().to_string(),
        "study.toml: there is no cell 1: the study has 1"
    );
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
    assert_eq!(study.config.sweep.len(), 2);
    assert!(study.cells().all(|cell| cell.config.sweep.is_empty()));
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
fn ranges_keep_their_ends_and_round_between() {
    let study = study(
        r#"
        [[sweep]]
        path = "scene.object.radius"
        from = 0.01
        to = 100
        count = 5
        spacing = "log"
        [[sweep]]
        path = "scene.motion.spin_rad_per_s"
        from = 0
        to = 0.4
        count = 5"#,
    );
    let all = coordinates(&study);
    let slow: Vec<_> = all.iter().step_by(5).map(|pair| pair[0].as_str()).collect();
    let fast: Vec<_> = all[..5].iter().map(|pair| pair[1].as_str()).collect();
    assert_eq!(slow, ["0.01", "0.1", "1", "10", "100"]);
    assert_eq!(fast, ["0", "0.1", "0.2", "0.3", "0.4"]);
}

#[test]
fn extreme_ranges_stay_finite() {
    let ends = |from: &str, to: &str, spacing: &str| {
        let text = format!(
            "[[sweep]]\npath = \"scene.object.radius\"\nfrom = {from}\nto = {to}\ncount = 3\nspacing = \"{spacing}\""
        );
        let study = study(&text);
        coordinates(&study)
            .concat()
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
    };
    assert_eq!(ends("1e-300", "1e300", "log"), ["1e-300", "1", "1e300"]);
    assert_eq!(
        ends("1e-308", "1.7e308", "linear"),
        ["1e-308", "8.5e307", "1.7e308"]
    );
    assert_eq!(ends("2", "1", "linear"), ["2", "1.5", "1"]);
}

#[test]
fn a_range_of_one_value_and_of_counts() {
    let one = study("[[sweep]]\npath = \"scene.object.radius\"\nfrom = 2\nto = 2.0\ncount = 1");
    assert_eq!(coordinates(&one), [["2"]]);
    let counts = study("[[sweep]]\npath = \"trials\"\nfrom = 100.0\nto = 300\ncount = 3");
    assert_eq!(
        counts
            .cells()
            .map(|cell| cell.config.trials)
            .collect::<Vec<_>>(),
        [100, 200, 300]
    );
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

#[test]
fn headers_carry_the_unit_of_the_study() {
    let sweep = "[[sweep]]\npath = \"scene.object.radius\"\nvalues = [1]";
    for unit in ["m", "mm", "um", "unit"] {
        let text = edited("\"cm\"", &format!("{unit:?}")) + sweep;
        assert_eq!(
            parse("study.toml", &text).unwrap().columns,
            [format!("scene.object.radius_{unit}")]
        );
    }
}

#[test]
fn a_million_cells_are_the_limit() {
    let axes = |count| {
        format!(
            "{BASE}[[sweep]]\npath = \"scene.object.radius\"\nfrom = 1\nto = 2\ncount = {count}\n\
             [[sweep]]\npath = \"scene.probe.radius\"\nfrom = 1\nto = 2\ncount = 1000\n"
        )
    };
    assert_eq!(
        parse("study.toml", &axes(1001)).unwrap_err().to_string(),
        r#"study.toml:14:1: sweep.1: the axes make 1001000 cells; at most 1000000 are allowed
   |
14 | [[sweep]]
   | ^^^^^^^^^"#
    );
    let error = parse("study.toml", &axes(u32::MAX)).unwrap_err();
    assert_eq!(error.path(), "sweep.0");
}

#[test]
fn later_errors_point_at_the_value_of_the_cell() {
    let study = study("[[sweep]]\npath = \"scene.object.radius\"\nvalues = [4, 3]\n");
    assert_eq!(
        study
            .error_at(1, "scene.object.radius", "is less than the probe's")
            .to_string(),
        r#"study.toml:11:14: scene.object.radius: is less than the probe's
   |
11 | values = [4, 3]
   |              ^
   = in cell 1: scene.object.radius = 3"#
    );
}

#[test]
fn later_errors_in_what_is_not_written_point_at_the_parent() {
    let error = study("").error_at(0, "scene.sensor.pitch", "is larger than the probe");
    assert_eq!(
        error.to_string(),
        "study.toml:4:1: scene.sensor.pitch: is larger than the probe\n  |\n4 | [scene]\n  | ^^^^^^^"
    );
    assert_eq!(
        (error.path(), error.message()),
        ("scene.sensor.pitch", "is larger than the probe")
    );
}

#[test]
fn errors_in_a_text_point_at_their_part() {
    let text = edited(
        r#"{ kind = "sphere", radius = 5.0 }"#,
        r#"{ kind = "height-field", formula = "x + foo*y" }"#,
    );
    let study = parse("study.toml", &text).unwrap();
    assert_eq!(
        study
            .error_in_text(0, "scene.object.formula", 4..7, "unknown name `foo`")
            .to_string(),
        r#"study.toml:7:50: scene.object.formula: unknown name `foo`
  |
7 | object = { kind = "height-field", formula = "x + foo*y" }
  |                                                  ^^^"#
    );
}

#[test]
fn overrides_reach_every_cell() {
    let mut study = study("[[sweep]]\npath = \"scene.object.radius\"\nvalues = [4, 3]\n");
    study.override_seed(42).unwrap();
    study.override_trials(7).unwrap();
    let all = study.cells().map(|cell| cell.config);
    let mut all = all.chain([study.config.clone()]);
    assert!(all.all(|config| (config.seed, config.trials) == (42, 7)));
}

#[test]
fn overrides_are_checked() {
    let mut plain = study("");
    assert_eq!(
        plain.override_trials(0).unwrap_err().to_string(),
        "study.toml: trials: must be between 1 and 9223372036854775807, is 0"
    );
    assert_eq!(
        plain.override_seed(u64::MAX).unwrap_err().to_string(),
        "study.toml: seed: must be between 0 and 9223372036854775807, is 18446744073709551615"
    );
    let mut swept = study("[[sweep]]\npath = \"seed\"\nvalues = [1, 2]\n");
    assert_eq!(
        swept.override_seed(3).unwrap_err().to_string(),
        "study.toml:10:8: seed: is swept, and so cannot be set to 3\n   |\n10 | path = \"seed\"\n   |        ^^^^^^"
    );
}

/// A field of a table that is left out can be swept: the table stands with its defaults.
#[test]
fn fields_of_defaulted_tables_can_be_swept() {
    let glide = r#"
        name = "a-glide"
        [scene]
        kind = "glide"
        probe = { kind = "sphere", radius = 4.0 }
        object = { kind = "saddle", a = 0.01 }
        motion = { finger_positions = [-15.0, 0.0, 15.0], inter_finger_distance = 10.0, patch_length = 30.0, contacts_per_finger = 10 }
        evaluate = { half_width = 10.0, gaussian_threshold = 0.00005, mean_threshold = 0.003 }
        [[sweep]]
        path = "PATH"
        values = VALUES
    "#;
    let cells = |path: &str, values: &str| {
        let text = glide.replace("PATH", path).replace("VALUES", values);
        let study = palpate_study::config::parse("study.toml", &text);
        study.map(|study| study.cells().map(|cell| cell.config).collect::<Vec<_>>())
    };
    let swept = cells("scene.sensor.normals", "[true, false]");
    let swept = swept.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(swept.len(), 2);
    assert_ne!(swept[0], swept[1]);
    let error = cells("scene.sensr.normals", "[1]").expect_err("misspelt");
    assert!(error.to_string().contains("has no `sensr`"), "{error}");
    let error = cells("scene.sensor.normls", "[1]").expect_err("misspelt");
    assert!(error.to_string().contains("normls"), "{error}");
}
