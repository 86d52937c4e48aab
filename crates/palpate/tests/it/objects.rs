//! Tests all combinations of objects, sensors and kinds of noise.

use super::desk::Desk;

const OBJECTS: [&str; 9] = [
    r#"{ label = "sphere", kind = "sphere", radius = 5.0 }"#,
    r#"{ label = "dish", kind = "dish", radius = 5.0 }"#,
    r#"{ label = "plane", kind = "plane" }"#,
    r#"{ label = "cylinder", kind = "cylinder", radius = 5.0, direction_deg = 30.0 }"#,
    r#"{ label = "ellipsoid", kind = "ellipsoid", semi_axes = [5.0, 4.0, 3.0] }"#,
    r#"{ label = "torus", kind = "torus", major_radius = 5.0, minor_radius = 2.0 }"#,
    r#"{ label = "paraboloid", kind = "paraboloid", c = 0.1 }"#,
    r#"{ label = "saddle", kind = "saddle", a = 0.1 }"#,
    r#"{ label = "waves", kind = "height-field", formula = "A*sin(k*x)*cos(k*y)", parameters = { A = 0.15, k = 0.7 } }"#,
];

const SENSORS: [&str; 5] = [
    r#"{ label = "ideal", kind = "ideal" }"#,
    r#"{ label = "wrist", kind = "wrist", std = 0.001 }"#,
    r#"{ label = "square", kind = "pads", pitch = 0.01 }"#,
    r#"{ label = "square, anywhere", kind = "pads", pitch = 0.01, offset = "random" }"#,
    r#"{ label = "uniform", kind = "pads", pitch = 0.01, layout = "uniform", offset = "random" }"#,
];

const NOISES: [&str; 6] = [
    r#"{ label = "none" }"#,
    r#"{ label = "probe", angular_velocity = { kind = "uniform", fraction = 0.01 } }"#,
    r#"{ label = "instant", angular_velocity = { kind = "gaussian", fraction = 0.01, when = "per-instant", instants = 3 } }"#,
    r#"{ label = "measured", angular_velocity = { kind = "gaussian", fraction = 0.01, side = "measurement" } }"#,
    r#"{ label = "measured, instant", angular_velocity = { kind = "uniform", fraction = 0.01, when = "per-instant", instants = 3, side = "measurement" } }"#,
    r#"{ label = "encoder", encoder = { step_rad = 0.001 } }"#,
];

fn axis(path: &str, values: &[&str]) -> String {
    format!(
        "[[sweep]]\npath = \"{path}\"\nvalues = [\n{},\n]\n",
        values.join(",\n")
    )
}

#[test]
fn all_run() {
    let desk = Desk::with(&format!(
        r#"name = "all"
length_unit = "cm"
trials = 20

[scene]
kind = "roll"
probe = {{ kind = "sphere", radius = 1.0 }}
object = {{ kind = "plane" }}
motion = {{ rate_rad_per_s = 0.1, duration_s = 1.0 }}

{}{}{}"#,
        axis("scene.object", &OBJECTS),
        axis("scene.sensor", &SENSORS),
        axis("scene.noise", &NOISES),
    ));
    let cells = OBJECTS.len() * SENSORS.len() * NOISES.len();
    desk.palpate("run c.toml --out o").printed();
    let table = desk.table("o/cells.csv");
    assert_eq!(table.rows.len(), 5 * cells);
    assert_eq!(desk.table("o/failures.csv").rows.len(), 0);
    for cell in 0..cells {
        for quantity in ["normal_curvature_u", "normal_curvature_v", "mean_curvature"] {
            let row = table.row_of(cell, quantity);
            let [mean, truth] = ["mean", "truth"].map(|column| table.number(row, column));
            // The tolerance is large, because the contact moves by only a few pads. The pitch of the pads is a
            // hundredth of the probe's radius, and the roll angle is a tenth of a radian.
            assert!(
                (mean - truth).abs() < 0.25,
                "{:?}: {mean}, {truth}",
                table.rows[row]
            );
        }
    }
}
