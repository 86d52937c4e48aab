//! Compares results of the program with numbers of Charlebois, Gupta and Payandeh (1996), or of an independent
//! simulation.

use super::desk::{Desk, assert_close};

/// Tests the mean relative errors of the normal curvature if the angular velocity of each of eight probes has an error
/// of up to 1 %. The expected numbers are from an independent simulation.
#[test]
fn monte_carlo_reference() {
    let desk = Desk::with(
        r#"name = "reference"
length_unit = "cm"
seed = 1996
trials = 20000

[scene]
kind = "roll"
probe = { kind = "sphere", radius = 1.0 }
object = { kind = "sphere", radius = 1.0 }
motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
noise = { angular_velocity = { kind = "uniform", fraction = 0.01, when = "per-probe" } }

[[sweep]]
path = "scene.object.radius"
values = [500, 50, 5, 1, 0.5]
"#,
    );
    desk.palpate("run c.toml --out o").printed();
    let table = desk.table("o/cells.csv");
    for (cell, percent) in [117.0, 11.9, 1.40, 0.466, 0.350].into_iter().enumerate() {
        let row = table.row_of(cell, "normal_curvature_u");
        assert_close(
            100.0 * table.number(row, "relative_mean_abs_error"),
            percent,
            0.02,
        );
    }
}

/// Checks the estimated curvature of a sphere with a radius of 50 mm. It must be exactly 0 with square grids of pads
/// whose pitch is 0.5 mm and 1 mm, because both grids report a shift of 1 mm, as on a plane.
fn assert_exact_zeros(unit: &str, millimetre: f64) {
    let [probe, object, fine, coarse] = [10.0, 50.0, 0.5, 1.0].map(|length| length * millimetre);
    let desk = Desk::with(&format!(
        r#"name = "zeros"
length_unit = "{unit}"

[scene]
kind = "roll"
probe = {{ kind = "sphere", radius = {probe} }}
object = {{ kind = "sphere", radius = {object} }}
motion = {{ rate_rad_per_s = 0.1, duration_s = 1.0 }}
sensor = {{ kind = "pads", pitch = 1.0, layout = "square", offset = "centred" }}

[[sweep]]
path = "scene.sensor.pitch"
values = [{fine}, {coarse}, {}]
"#,
        0.01 * millimetre
    ));
    desk.palpate("run c.toml --out o").printed();
    let table = desk.table("o/cells.csv");
    for cell in [0, 1] {
        let row = table.row_of(cell, "normal_curvature_u");
        assert_eq!(table.text(row, "mean"), "0", "pitch {}", table.rows[row][1]);
        assert_eq!(table.number(row, "relative_mean_abs_error"), 1.0);
    }
    // With finer pads, the mean of the estimated curvature is no longer 0.
    assert!(table.number(table.row_of(2, "normal_curvature_u"), "mean") > 0.0);
}

#[test]
fn exact_zeros_in_millimetres_and_centimetres() {
    assert_exact_zeros("mm", 1.0);
    assert_exact_zeros("cm", 0.1);
}
