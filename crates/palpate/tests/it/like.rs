//! Tests `palpate estimate … --like STUDY.toml`, which estimates from recorded readings with the settings of a study.

use serde_json::Value;

use super::desk::{Desk, assert_close, edited};

const ROLL: &str = r#"name = "rolls"
length_unit = "mm"
[scene]
kind = "roll"
probe = { kind = "sphere", radius = 10.0 }
object = { kind = "sphere", radius = 30.0 }
motion = { rate_rad_per_s = 0.5, duration_s = 1.0 }
sensor = { kind = "pads", pitch = 0.5, offset = "random" }
noise = { angular_velocity = { kind = "gaussian", fraction = 0.01, side = "measurement" } }
"#;

const GLIDE: &str = r#"name = "glides"
length_unit = "mm"
[scene]
kind = "glide"
probe = { kind = "sphere", radius = 5.0 }
object = { kind = "cylinder", radius = 40.0 }
motion = { finger_positions = [-15.0, 0.0, 15.0], inter_finger_distance = 10.0, patch_length = 30.0, contacts_per_finger = 10 }
noise = { position = { kind = "gaussian", fraction_of_ifd = 0.01 }, normal = { kind = "gaussian", std_deg = 1.0 } }
estimator = { kind = "penalised", criterion = "reml", intervals = 4, position_std = 0.1, normal_std_deg = 1.0 }
evaluate = { half_width = 10.0, gaussian_threshold = 0.0001, mean_threshold = 0.004 }
"#;

pub(crate) const PRESS: &str = r#"name = "presses"
length_unit = "mm"
[scene]
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }
object = { kind = "sphere", radius = 30.0 }
motion = { indentation = 1.5 }
model = { kind = "bonded-layer", thickness = 5.0 }
noise = { normal_displacement = { kind = "gaussian", std = 0.05 }, tangential_displacement = { kind = "gaussian", std = 0.02 } }
estimator = { kind = "bonded-layer", indentation = "fitted", gain_std = 0.02 }
"#;

/// A directory with a study as `c.toml`, and with the readings of trial 3 in `t`.
fn traced(study: &str) -> Desk {
    let desk = Desk::with(study);
    desk.palpate("trace c.toml --out t --trial 3").printed();
    desk
}

fn json(desk: &Desk, arguments: &str) -> Value {
    desk.json(&format!("estimate {arguments}"))
}

#[test]
fn settings_of_a_study_equal_the_same_settings_as_flags() {
    for (study, kind, flags) in [
        (
            ROLL,
            "roll",
            "--probe-radius 10 --pitch 0.5 --relative-rotation-std 0.01",
        ),
        (
            GLIDE,
            "glide",
            "--criterion reml --intervals 4 --position-std 0.1 --normal-std-deg 1 --gaussian-threshold 0.0001 --mean-threshold 0.004",
        ),
        (
            PRESS,
            "press",
            "--sensor-radius 20 --depth 2 --method bonded-layer --thickness 5 --gain-std 0.02 --normal-std 0.05 --tangential-std 0.02",
        ),
    ] {
        let desk = traced(study);
        let readings = format!("{kind} t/readings.csv");
        let estimate = json(&desk, &format!("{readings} --like c.toml"));
        assert_eq!(
            estimate,
            json(&desk, &format!("{readings} {flags}")),
            "{kind}"
        );
        // Without the other settings of the study, the estimate must differ. Otherwise this test would not show that
        // `--like` uses these settings.
        let bare = match kind {
            "roll" => "--probe-radius 10",
            "press" => "--sensor-radius 20 --depth 2 --method bonded-layer --thickness 5",
            _ => "",
        };
        assert_ne!(
            estimate,
            json(&desk, &format!("{readings} {bare}")),
            "{kind}"
        );
    }
}

#[test]
fn lengths_are_converted_to_the_readings_unit() {
    let press = PRESS
        .replace("\"mm\"", "\"m\"")
        .replace("radius = 20.0", "radius = 0.02")
        .replace("marker_depth = 2.0", "marker_depth = 0.002")
        .replace("radius = 30.0", "radius = 0.03")
        .replace("indentation = 1.5", "indentation = 0.0015")
        .replace("thickness = 5.0", "thickness = 0.005")
        .replace("std = 0.05", "std = 0.00005")
        .replace("std = 0.02 }, t", "std = 0.00002 }, t")
        .replace("\"gaussian\", std = 0.02", "\"gaussian\", std = 0.00002");
    let glide = GLIDE
        .replace("\"mm\"", "\"cm\"")
        .replace("radius = 5.0", "radius = 0.5")
        .replace("radius = 40.0", "radius = 4.0")
        .replace("[-15.0, 0.0, 15.0]", "[-1.5, 0.0, 1.5]")
        .replace(
            "distance = 10.0, patch_length = 30.0",
            "distance = 1.0, patch_length = 3.0",
        )
        .replace("position_std = 0.1", "position_std = 0.01")
        .replace(
            "half_width = 10.0, gaussian_threshold = 0.0001, mean_threshold = 0.004",
            "half_width = 1.0, gaussian_threshold = 0.01, mean_threshold = 0.04",
        );
    let roll = ROLL
        .replace("\"mm\"", "\"um\"")
        .replace("radius = 10.0", "radius = 10000.0")
        .replace("radius = 30.0", "radius = 30000.0")
        .replace("pitch = 0.5", "pitch = 500.0");
    for (study, other, kind, quantity) in [
        (ROLL, roll, "roll", "mean_curvature"),
        (GLIDE, glide, "glide", "mean_curvature"),
        (PRESS, press, "press", "object_curvature"),
    ] {
        let desk = traced(study);
        desk.write("other.toml", other);
        let estimate = |study| json(&desk, &format!("{kind} t/readings.csv --like {study}"));
        let (of_one, of_other) = (estimate("c.toml"), estimate("other.toml"));
        for number in ["value", "std"] {
            let [a, b] = [&of_one, &of_other].map(|json| json[quantity][number].as_f64().unwrap());
            assert_close(a, b, 1e-6 * a.abs());
        }
    }
    let desk = traced(&edited(ROLL, "\"mm\"", "\"unit\""));
    desk.write(
        "mm.csv",
        desk.read("t/readings.csv").replace("_unit", "_mm"),
    );
    desk.palpate("estimate roll mm.csv --like c.toml").fails(
        2,
        "c.toml:2:15: length_unit: the unit of the study is unit, but the unit of the readings is mm",
    );
}

#[test]
fn a_flag_overrides_the_study() {
    let desk = traced(PRESS);
    let like = "press t/readings.csv --like c.toml";
    let with = |flags: &str| json(&desk, &format!("{like} {flags}"));
    assert_eq!(with("--method half-space")["method"], "half-space");
    assert_eq!(
        with("--normal-std 0.07")["noise"]["normal_std"]["value"],
        0.07
    );
    assert!(!with("--baseline fitted")["baseline"].is_null());
    let found = with("--noise found")["noise"]["normal_std"]["value"]
        .as_f64()
        .unwrap();
    assert!(
        found != 0.05 && (0.5..2.0).contains(&(found / 0.05)),
        "{found}"
    );
    // The study fits the indentation. If the command states an indentation, this indentation is used instead.
    assert!(with("")["indentation"]["std"].as_f64().unwrap() > 0.0);
    let estimate = with("--indentation 1.5 --indentation-std 1e-9");
    assert_close(
        estimate["indentation"]["value"].as_f64().unwrap(),
        1.5,
        1e-8,
    );
    // The study fits the gain. If the command states another method that can fit a gain, the gain is still fitted.
    assert!(!with("--method half-space")["gain"].is_null());
    desk.palpate(&format!("estimate {like} --window 5"))
        .fails(2, "--window has an effect only with --method gaussian");
}

#[test]
fn the_indentation_of_a_study_is_not_used() {
    let desk = traced(&edited(
        PRESS,
        "\"fitted\"",
        "\"known\", indentation_std = 0.01",
    ));
    let estimate = json(&desk, "press t/readings.csv --like c.toml");
    assert_ne!(estimate["indentation"]["value"], 1.5);
    let estimate = json(
        &desk,
        "press t/readings.csv --like c.toml --indentation 1.5",
    );
    assert!(estimate["indentation"]["std"].as_f64().unwrap() <= 0.01);
}

#[test]
fn every_setting_is_a_flag() {
    let schema: Value = serde_json::from_str(&Desk::new().palpate("schema").printed()).unwrap();
    let scenes = schema["properties"]["scene"]["oneOf"].as_array().unwrap();
    let mut count = 0;
    for scene in scenes {
        let kind = scene["properties"]["kind"]["const"].as_str().unwrap();
        let Some(estimators) = scene["properties"]["estimator"]["oneOf"].as_array() else {
            continue;
        };
        let help = Desk::new()
            .palpate(&format!("estimate {kind} --help"))
            .printed();
        for estimator in estimators {
            for key in estimator["properties"].as_object().unwrap().keys() {
                let flag = match key.as_str() {
                    "kind" => "--method".to_owned(),
                    key => format!("--{}", key.replace('_', "-")),
                };
                assert!(help.contains(&format!("{flag} <")), "{kind} {flag}: {help}");
                count += 1;
            }
        }
    }
    assert!(count > 30, "{count}");
}
