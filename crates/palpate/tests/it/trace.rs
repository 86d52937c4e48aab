//! Tests `palpate trace`: true values, readings, and estimates from these readings.

use super::desk::{Desk, SCENE, STUDY, assert_close, edited};

const HEADER: &str = "probe,t_s,object_x_mm,object_y_mm,object_z_mm,probe_x_mm,probe_y_mm,\
    probe_z_mm,normal_x,normal_y,normal_z,arc_length_mm";

#[test]
fn every_probe_starts_at_the_first_contact() {
    let desk = Desk::with(SCENE);
    let printed = desk.palpate("trace c.toml --out t").printed();
    assert!(
        printed.ends_with("contacts of 8 probes -> t\n"),
        "{printed}"
    );
    assert_eq!(desk.names("t"), ["readings.csv", "trace.csv"]);
    assert_eq!(
        desk.table("t/readings.csv").header.join(","),
        "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm"
    );
    let trace = desk.table("t/trace.csv");
    assert_eq!(trace.header.join(","), HEADER);
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

/// Rolls whose final contacts were computed by an independent program. The crate `palpate-rolling` tests its models
/// with the same table.
const GOLDENS: &str = include_str!("../../../rolling/tests/it/golden.csv");

#[test]
fn rolls_by_the_model_that_auto_chooses_end_at_the_golden_contacts() {
    for row in GOLDENS.lines().skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        let number = |column: usize| fields[column].parse::<f64>().unwrap();
        let object = match fields[1] {
            "ellipsoid" => "semi_axes = [5, 3, 2]".to_owned(),
            "height-field" => {
                let parameters = fields[2].replace(' ', ", ");
                format!("formula = \"A*sin(k*x)*cos(k*y)\", parameters = {{ {parameters} }}")
            }
            _ => fields[2].to_owned(),
        };
        let desk = Desk::with(&format!(
            r#"name = "golden"
scene.kind = "roll"
scene.probe = {{ kind = "sphere", radius = {} }}
scene.object = {{ kind = "{}", {object} }}
scene.object_contact = [{}, {}]
scene.motion = {{ rate_rad_per_s = {}, duration_s = {}, directions_deg = [{}] }}
scene.model = {{ kind = "auto", tolerance = 1e-12 }}
"#,
            fields[8], fields[1], fields[3], fields[4], fields[6], fields[7], fields[5]
        ));
        desk.palpate("trace c.toml --out t").printed();
        let trace = desk.table("t/trace.csv");
        assert_close(trace.number(0, "object_x_unit"), number(3), 1e-15);
        assert_close(trace.number(0, "object_y_unit"), number(4), 1e-15);
        let last = trace.rows.len() - 1;
        for (name, column) in trace.header[2..8].iter().zip(9..) {
            let off = (trace.number(last, name) - number(column)).abs();
            assert!(off < 1e-9, "{row}: {name} is off by {off:e}");
        }
        let off = (trace.number(last, "arc_length_unit") - number(15)).abs();
        assert!(off < 1e-6, "{row}: the arc length is off by {off:e}");
        assert_close(trace.number(last, "t_s"), number(7), 0.0);
    }
}

fn estimate(desk: &Desk, arguments: &str) -> serde_json::Value {
    desk.json(&format!("estimate roll {arguments}"))
}

fn value(estimate: &serde_json::Value, quantity: &str) -> f64 {
    estimate[quantity]["value"].as_f64().unwrap()
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
    for (place, noise) in motions.iter().enumerate() {
        for sensor in [sensors[place], sensors[(place + 1) % 4]] {
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
fn a_roll_that_ends_early_is_an_error() {
    let off = "sensor = { kind = \"pads\", pitch = 1, cap_deg = 15 }\n";
    let desk = Desk::with(&format!("{SCENE}{off}"));
    desk.palpate("trace c.toml --out t").fails(1, "probe 0: ");
    assert!(!desk.path("t").exists());
}

#[test]
fn sampled_rolls_are_written_as_time_series() {
    let motion = "duration_s = 1.0, sampling_hz = 10, directions_deg = [0, 90]";
    let scene = edited(SCENE, "duration_s = 1.0", motion);
    let desk = Desk::with(&scene);
    desk.palpate("trace c.toml --out t").printed();
    let readings = desk.table("t/readings.csv");
    let header = "probe,time_s,rotation_x_rad,rotation_y_rad,contact_u_mm,contact_v_mm";
    assert_eq!(readings.header.join(","), header);
    assert_eq!(readings.rows.len(), 2 * 11);
    for (row, time) in [(0, 0.0), (3, 0.3), (10, 1.0)] {
        assert_close(readings.number(row, "time_s"), time, 1e-15);
        assert_close(readings.number(row, "rotation_y_rad"), -0.5 * time, 1e-14);
        let contact = 0.5 * time / (1.0 / 10.0 + 1.0 / 50.0);
        assert_close(readings.number(row, "contact_u_mm"), contact, 1e-13);
    }
    let estimate = estimate(&desk, "t/readings.csv --probe-radius 10");
    assert_close(value(&estimate, "mean_curvature"), 1.0 / 50.0, 1e-12);
}

#[test]
fn a_traced_series_has_the_estimate_of_its_trial() {
    let rolls =
        "duration_s = 1.0, sampling_hz = 300, directions_deg = [14, 74, 134, 194, 254, 314]";
    for (sensor, method, options) in [
        (
            r#"kind = "pads", pitch = 1.0, offset = "random""#,
            "trajectory",
            "--pitch 1",
        ),
        (
            r#"kind = "pads", pitch = 1.0, layout = "hexagonal", offset = "random""#,
            "trajectory",
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
        let arguments = format!("t/readings.csv --probe-radius 10 --method auto {options}");
        let estimate = estimate(&desk, &arguments);
        assert_eq!(estimate["method"], method);
        for (row, quantity) in ["normal_curvature_u", "normal_curvature_v"]
            .iter()
            .enumerate()
        {
            let value = value(&estimate, quantity);
            // The table has no rotations about the normal, so the estimate assumes rolls without spin.
            assert_close(value, cells.number(row, "mean"), 2e-3);
            assert_close(value, 1.0 / 50.0, 0.05);
        }
    }
}
