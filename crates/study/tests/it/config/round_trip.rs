//! Tests that a config, written as TOML with all its defaults, describes the same study as the original config.

use std::path::Path;

use super::{BASE, edited, study};
use palpate_study::config::{Study, load, parse, to_toml};

fn returns(study: &Study) -> String {
    let text = to_toml(&study.config);
    let again = parse("run.toml", &text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert!(again.cells().eq(study.cells()), "{text}");
    assert_eq!(again.columns, study.columns);
    assert_eq!(again.config, study.config);
    assert_eq!(to_toml(&again.config), text);
    text
}

#[test]
fn defaults_are_filled_in() {
    assert_eq!(
        returns(&study("")),
        r#"name = "a-study"
title = ""
source = ""
length_unit = "cm"
seed = 0
trials = 10000
outputs = ["cells"]

[scene]
kind = "roll"

[scene.probe]
kind = "sphere"
radius = 1.0

[scene.object]
kind = "sphere"
radius = 5.0

[scene.motion]
rate_rad_per_s = 0.1
duration_s = 1.0
spin_rad_per_s = 0.0
directions_deg = [0.0, 0.0, 90.0, 90.0, 180.0, 180.0, 270.0, 270.0]
axis = "transported"

[scene.model]
kind = "auto"
tolerance = 0.000000001
chart = "free"

[scene.sensor]
kind = "ideal"

[scene.noise]

[scene.estimator]
kind = "least-squares"
"#
    );
}

#[test]
fn everything_returns() {
    returns(&study(
        r#"
        object_contact = [0.5, -0.25]
        model = { kind = "rk4", steps = 7, chart = "montana" }
        sensor = { kind = "pads", pitch = 0.01, layout = "uniform", offset = "random", cap_deg = 60 }
        [scene.noise]
        angular_velocity = { kind = "gaussian", fraction = 1e-300, when = "per-instant", side = "measurement" }
        encoder = { step_rad = 1e-3 }
        [[sweep]]
        path = "scene.object"
        values = [
            { label = "egg", kind = "ellipsoid", semi_axes = [1, 2, 3] },
            { label = "wave", kind = "height-field", formula = "A*sin(k*x)", parameters = { A = 0.15, k = 7 } },
        ]
        [[sweep]]
        paths = ["scene.probe.radius", "scene.motion"]
        values = [
            [1, { label = "time", rate_rad_per_s = 1, duration_s = 2 }],
            [2.5, { label = "length", rate_rad_per_s = 1, arc_length = 2 }],
        ]
        [[sweep]]
        path = "scene.sensor.pitch"
        from = 1e-3
        to = 1
        count = 4
        spacing = "log"
        [[plot]]
        name = "first"
        x = "scene.sensor.pitch"
        y = "rms_error"
        quantity = "mean_curvature"
        series = "scene.object"
        panels = "quantity"
        where = { "scene.object" = ["egg"], "scene.probe.radius" = 1 }
        scale = "log-x"
        compare = "mean_reported_std"
        marks = [{ axis = "y", value = 0.15, label = "15 %" }]
        [[plot.points]]
        label = "published"
        x = [0.1, 1]
        y = [1e-3, 2]
        series = "egg"
        panel = "mean_curvature""#,
    ));
}

#[test]
fn a_swept_kind_returns_although_kinds_know_different_keys() {
    let sweep = r#"
        [[sweep]]
        path = "scene.model.kind"
        values = ["auto", "closed-form", "dop853"]"#;
    let text = returns(
        &parse(
            "study.toml",
            &(BASE.to_string() + "model = { kind = \"auto\" }\n" + sweep),
        )
        .unwrap(),
    );
    assert!(
        text.contains("[scene.model]\nkind = \"auto\"\n\n"),
        "{text}"
    );

    let text = edited(
        r#"{ kind = "sphere", radius = 5.0 }"#,
        r#"{ kind = "cylinder", radius = 5.0 }"#,
    );
    let sweep = "[[sweep]]\npath = \"scene.object.kind\"\nvalues = [\"cylinder\", \"dish\"]";
    returns(&parse("study.toml", &(text + sweep)).unwrap());
}

#[test]
fn overrides_and_the_version_are_written() {
    let mut study = study("");
    study.override_numbers(Some(i64::MAX as u64), None).unwrap();
    study.config.crate_version = Some("0.0.3".into());
    let text = to_toml(&study.config);
    assert!(
        text.contains("seed = 9223372036854775807\n")
            && text.contains("crate_version = \"0.0.3\"\n")
    );
    let again = parse("run.toml", &text).unwrap();
    assert_eq!(again.config.crate_version, None);
    assert!(again.cells().eq(study.cells()));
}

#[test]
fn committed_configs_return() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    for folder in ["sim-configs", "examples"] {
        for entry in root.join(folder).read_dir().unwrap() {
            let path = entry.unwrap().path();
            if path
                .extension()
                .is_some_and(|extension| extension == "toml")
            {
                returns(&load(&path).unwrap());
            }
        }
    }
}
