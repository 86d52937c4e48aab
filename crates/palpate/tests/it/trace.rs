//! Tests `palpate trace`: true values, readings, and estimates from these readings.

use super::desk::{Desk, SCENE, STUDY, Table, assert_close, edited};

const HEADER: &str = "probe,t_s,object_x_mm,object_y_mm,object_z_mm,probe_x_mm,probe_y_mm,\
    probe_z_mm,normal_x,normal_y,normal_z,arc_length_mm";

#[test]
fn two_tables_are_written() {
    let desk = Desk::with(SCENE);
    let printed = desk.palpate("trace c.toml --out t").printed();
    assert!(
        printed.ends_with("contacts of 8 probes -> t\n"),
        "{printed}"
    );
    assert_eq!(desk.names("t"), ["readings.csv", "trace.csv"]);
    assert_eq!(desk.read("t/trace.csv").lines().next(), Some(HEADER));
    assert_eq!(
        desk.read("t/readings.csv").lines().next(),
        Some("probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm")
    );
}

#[test]
fn every_probe_starts_at_the_first_contact() {
    let desk = Desk::with(SCENE);
    desk.palpate("trace c.toml --out t").printed();
    let trace = desk.table("t/trace.csv");
    let starts: Vec<&Vec<String>> = trace.rows.iter().filter(|row| row[1] == "0").collect();
    assert_eq!(starts.len(), 8);
    for (probe, start) in starts.into_iter().enumerate() {
        assert_eq!(start[0], probe.to_string());
        let expected = ["0", "0", "50", "0", "0", "-10", "0", "0", "1", "0"];
        assert_eq!(start[2..], expected);
    }
    let last = trace.rows.len() - 1;
    assert_eq!(trace.text(last, "t_s"), "1");
    assert_close(
        trace.number(last, "arc_length_mm"),
        0.5 / (1.0 / 10.0 + 1.0 / 50.0),
        1e-12,
    );
}

/// A roll whose final contact was computed by an independent program.
struct Golden {
    object: &'static str,
    contact: [f64; 2],
    direction_deg: f64,
    rate_rad_per_s: f64,
    duration_s: f64,
    radius: f64,
    /// Coordinates of the last contact point: three on the object, then three on the probe.
    end: [f64; 6],
    arc_length: f64,
}

const GOLDENS: [Golden; 5] = [
    Golden {
        object: r#"{ kind = "paraboloid", c = 0.5 }"#,
        contact: [0.3, -0.2],
        direction_deg: 30.0,
        rate_rad_per_s: 0.5,
        duration_s: 1.0,
        radius: 1.0,
        end: [
            0.518114353286,
            -0.0586409106607,
            -0.135940619742,
            -0.0456512106228,
            0.316435440255,
            -0.947514949285,
        ],
        arc_length: 0.27002799,
    },
    Golden {
        object: r#"{ kind = "saddle", a = 0.1 }"#,
        contact: [0.3, -0.2],
        direction_deg: 40.0,
        rate_rad_per_s: 1.0,
        duration_s: 3.0,
        radius: 1.0,
        end: [
            2.96607724431,
            1.45389749674,
            0.668379628816,
            -0.143214428412,
            -0.0429835339635,
            0.988757828441,
        ],
        arc_length: 3.2161128,
    },
    Golden {
        object: r#"{ kind = "ellipsoid", semi_axes = [5, 3, 2] }"#,
        contact: [1.0, 0.5],
        direction_deg: 75.0,
        rate_rad_per_s: 0.3,
        duration_s: 2.0,
        radius: 1.0,
        end: [
            1.13794376139,
            0.958628188127,
            1.83966932239,
            0.0623051793421,
            0.343904673688,
            -0.936935237913,
        ],
        arc_length: 0.48781496,
    },
    Golden {
        object: r#"{ kind = "sphere", radius = 5 }"#,
        contact: [0.0, 0.0],
        direction_deg: 20.0,
        rate_rad_per_s: 1.0,
        duration_s: 4.0,
        radius: 1.0,
        end: [
            2.90538770431,
            1.05747464337,
            3.92943630388,
            -0.179075308472,
            -0.0651780819758,
            0.981674004711,
        ],
        arc_length: 3.3333333,
    },
    Golden {
        object: r#"{ kind = "height-field", formula = "A*sin(k*x)*cos(k*y)", parameters = { A = 0.15, k = 0.7 } }"#,
        contact: [0.4, 0.9],
        direction_deg: 120.0,
        rate_rad_per_s: 0.8,
        duration_s: 2.5,
        radius: 0.8,
        end: [
            -0.469987847982,
            2.32512434547,
            0.00275078718454,
            -0.395052070712,
            0.598467759799,
            0.354640947871,
        ],
        arc_length: 1.6705908,
    },
];

fn last_contacts(golden: &Golden, model: &str) -> Table {
    let Golden {
        object,
        contact,
        direction_deg,
        rate_rad_per_s,
        duration_s,
        radius,
        ..
    } = golden;
    let desk = Desk::with(&format!(
        r#"name = "golden"

[scene]
kind = "roll"
probe = {{ kind = "sphere", radius = {radius} }}
object = {object}
object_contact = {contact:?}
motion = {{ rate_rad_per_s = {rate_rad_per_s}, duration_s = {duration_s}, directions_deg = [{direction_deg}] }}
model = {model}
"#
    ));
    desk.palpate("trace c.toml --out t").printed();
    desk.table("t/trace.csv")
}

fn assert_reaches_the_goldens(model: &str) {
    for golden in &GOLDENS {
        let trace = last_contacts(golden, model);
        let first = ["object_x_unit", "object_y_unit"].map(|name| trace.number(0, name));
        assert_close(first[0], golden.contact[0], 1e-15);
        assert_close(first[1], golden.contact[1], 1e-15);
        let last = trace.rows.len() - 1;
        let lengths = &trace.header[2..8];
        for (name, expected) in lengths.iter().zip(golden.end) {
            let off = (trace.number(last, name) - expected).abs();
            assert!(off < 1e-9, "{}: {name} is off by {off:e}", golden.object);
        }
        let off = (trace.number(last, "arc_length_unit") - golden.arc_length).abs();
        assert!(
            off < 1e-6,
            "{}: the arc length is off by {off:e}",
            golden.object
        );
        assert_close(trace.number(last, "t_s"), golden.duration_s, 0.0);
    }
}

#[test]
fn goldens_without_charts() {
    assert_reaches_the_goldens(r#"{ kind = "dop853", tolerance = 1e-12, chart = "free" }"#);
}

#[test]
fn goldens_by_the_model_chosen_by_auto() {
    assert_reaches_the_goldens(r#"{ kind = "auto", tolerance = 1e-12 }"#);
}

fn estimate(desk: &Desk, arguments: &str) -> serde_json::Value {
    let printed = desk
        .palpate(&format!("estimate roll {arguments}"))
        .printed();
    serde_json::from_str(&printed).unwrap()
}

fn value(estimate: &serde_json::Value, quantity: &str) -> f64 {
    estimate[quantity]["value"].as_f64().unwrap()
}

#[test]
fn estimates_from_a_trace_have_the_true_values() {
    let eight = "duration_s = 1.0, directions_deg = [0, 45, 90, 135, 180, 225, 270, 315]";
    let desk = Desk::with(&edited(SCENE, "duration_s = 1.0", eight));
    desk.palpate("trace c.toml --out t").printed();
    let json = estimate(&desk, "t/readings.csv --probe-radius 10");
    for quantity in ["normal_curvature_u", "normal_curvature_v", "mean_curvature"] {
        assert_close(value(&json, quantity), 0.02, 1e-12);
    }
    assert_close(value(&json, "gaussian_curvature"), 0.0004, 1e-12);
    assert_close(value(&json, "arc_length"), 0.5 / 0.12, 1e-12);
    assert_eq!(json["normal_curvature_u"]["unit"], "1/mm");
}

#[test]
fn a_traced_trial_has_the_estimates_of_the_run() {
    let motions = [
        r#"angular_velocity = { kind = "uniform", fraction = 0.02 }"#,
        r#"angular_velocity = { kind = "uniform", fraction = 0.2, when = "per-instant", instants = 7 }"#,
        r#"angular_velocity = { kind = "gaussian", fraction = 0.02, side = "measurement" }"#,
        r#"angular_velocity = { kind = "uniform", fraction = 0.2, when = "per-instant", instants = 7, side = "measurement" }, encoder = { step_rad = 0.003 }"#,
    ];
    let sensors = [
        r#"{ kind = "ideal" }"#,
        r#"{ kind = "wrist", std = 0.1 }"#,
        r#"{ kind = "pads", pitch = 0.3, offset = "random" }"#,
        r#"{ kind = "pads", pitch = 0.3, layout = "uniform", offset = "random" }"#,
    ];
    for noise in motions {
        for sensor in sensors {
            let desk = Desk::with(&format!(
                "{SCENE}noise = {{ {noise} }}\nsensor = {sensor}\n"
            ));
            desk.palpate("run c.toml --out o --trials 1").printed();
            desk.palpate("trace c.toml --out t --trial 0").printed();
            let json = estimate(&desk, "t/readings.csv --like c.toml");
            let cells = desk.table("o/cells.csv");
            for quantity in [
                "normal_curvature_u",
                "normal_curvature_v",
                "gaussian_curvature",
            ] {
                let mean = cells.number(cells.row_of(0, quantity), "mean");
                assert!((mean - cells.number(cells.row_of(0, quantity), "truth")).abs() > 1e-9);
                assert_close(value(&json, quantity), mean, 1e-9);
            }
        }
    }
}

#[test]
fn each_trial_has_its_own_noise() {
    let desk = Desk::with(STUDY);
    for (out, trial) in [
        ("none", ""),
        ("3", "--trial 3"),
        ("again", "--trial 3"),
        ("4", "--trial 4"),
    ] {
        desk.palpate(&format!("trace c.toml --out {out} {trial}"))
            .printed();
    }
    for file in ["trace.csv", "readings.csv"] {
        let of = |out: &str| desk.read(&format!("{out}/{file}"));
        assert_eq!(of("3"), of("again"));
        assert_ne!(of("3"), of("4"));
        assert_ne!(of("3"), of("none"));
    }
}

#[test]
fn a_cell_can_be_chosen() {
    let desk = Desk::with(STUDY);
    desk.palpate("trace c.toml --out t --cell 1").printed();
    assert_eq!(desk.table("t/trace.csv").number(0, "object_z_mm"), 5.0);
}

#[test]
fn one_direction_can_be_traced() {
    let one = edited(
        SCENE,
        "duration_s = 1.0",
        "duration_s = 1.0, directions_deg = [30]",
    );
    let desk = Desk::with(&one);
    desk.palpate("trace c.toml --out t").printed();
    assert_eq!(desk.table("t/readings.csv").rows.len(), 1);
}

#[test]
fn a_roll_that_ends_early_is_an_error() {
    let off = "sensor = { kind = \"pads\", pitch = 1, cap_deg = 15 }\n";
    let desk = Desk::with(&format!("{SCENE}{off}"));
    desk.palpate("trace c.toml --out t").fails(1, "probe 0: ");
    assert!(!desk.path("t").exists());
}

#[test]
fn one_finger_is_printed_in_the_singular() {
    let one = edited(super::glide::GLIDE, "[-15.0, 0.0, 15.0]", "[0.0]");
    let printed = Desk::with(&one).palpate("trace c.toml --out o").printed();
    assert_eq!(printed, "a-glide: 10 contacts of 1 finger -> o\n");
}

#[test]
fn sampled_rolls_are_written_as_time_series() {
    let motion = "duration_s = 1.0, sampling_hz = 10, directions_deg = [0, 90]";
    let scene = edited(SCENE, "duration_s = 1.0", motion);
    let desk = Desk::with(&scene);
    desk.palpate("trace c.toml --out t").printed();
    let readings = desk.table("t/readings.csv");
    let header = "probe,time_s,rotation_x_rad,rotation_y_rad,contact_u_mm,contact_v_mm";
    assert_eq!(desk.read("t/readings.csv").lines().next(), Some(header));
    assert_eq!(readings.rows.len(), 2 * 11);
    for (row, time) in [(0, 0.0), (3, 0.3), (10, 1.0)] {
        assert_close(readings.number(row, "time_s"), time, 1e-15);
        assert_close(readings.number(row, "rotation_y_rad"), -0.5 * time, 1e-14);
        let contact = 0.5 * time / (1.0 / 10.0 + 1.0 / 50.0);
        assert_close(readings.number(row, "contact_u_mm"), contact, 1e-13);
    }
    let printed = desk
        .palpate("estimate roll t/readings.csv --probe-radius 10")
        .printed();
    let estimate: serde_json::Value = serde_json::from_str(&printed).unwrap();
    let curvature = estimate["mean_curvature"]["value"].as_f64().unwrap();
    assert_close(curvature, 1.0 / 50.0, 1e-12);
}

#[test]
fn a_traced_series_has_the_estimate_of_its_trial() {
    let rolls =
        "duration_s = 1.0, sampling_hz = 300, directions_deg = [14, 74, 134, 194, 254, 314]";
    for (sensor, method, options) in [
        (
            r#"kind = "pads", pitch = 1.0, offset = "random""#,
            "pad-edge",
            "--pitch 1",
        ),
        (
            r#"kind = "pads", pitch = 1.0, layout = "hexagonal", offset = "random""#,
            "pad-edge",
            "--pitch 1 --pad-layout hexagonal",
        ),
        (
            r#"kind = "wrist", std = 0.05"#,
            "trajectory",
            "--shift-std 0.05",
        ),
    ] {
        let scene = edited(SCENE, "duration_s = 1.0", rolls)
            + &format!("sensor = {{ {sensor} }}\nestimator = {{ kind = \"auto\" }}\n");
        let desk = Desk::with(&scene);
        desk.palpate("run c.toml --trials 1 --out r").printed();
        let cells = desk.table("r/cells.csv");
        let check = desk.palpate("check c.toml").printed();
        let choice = format!("{method} over 6 probes, 1806 samples, chosen because");
        assert!(check.contains(&choice), "{check}");
        desk.palpate("trace c.toml --trial 0 --out t").printed();
        let estimate =
            format!("estimate roll t/readings.csv --probe-radius 10 --method auto {options}");
        let estimate = desk.palpate(&estimate).printed();
        let estimate: serde_json::Value = serde_json::from_str(&estimate).unwrap();
        assert_eq!(estimate["method"], method);
        for (row, quantity) in ["normal_curvature_u", "normal_curvature_v"]
            .iter()
            .enumerate()
        {
            let value = estimate[quantity]["value"].as_f64().unwrap();
            assert_close(value, cells.number(row, "mean"), 1e-12);
            assert_close(value, 1.0 / 50.0, 0.02);
        }
    }
}
