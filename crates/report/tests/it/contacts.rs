//! Tests the figure of kind `contacts`.

use crate::fixture::{count, drawn, refused, shows};
use crate::glides::{cells, config, study};
use palpate_report::Study;

const PLOT: &str =
    "[[plot]]\nname = \"contacts\"\nkind = \"contacts\"\ntitle = \"Three fingers\"\n";
const HEADER: &str =
    "finger,x_cm,y_cm,z_cm,normal_x,normal_y,normal_z,tip_x_cm,tip_y_cm,tip_z_cm\n";

/// Text of `trace.csv` for three fingers on the plane z = 0, with two contacts each. The fingers are `scale` apart, and
/// `tip` is the radius of their tips.
fn trace(scale: f64, tip: f64) -> String {
    let mut text = HEADER.to_owned();
    for finger in 0..3 {
        for x in [-1.0, 1.0] {
            let (x, y) = (x * scale, (f64::from(finger) - 1.0) * scale);
            text += &format!("{finger},{x},{y},0,0,0,1,{x},{y},{tip}\n");
        }
    }
    text
}

/// Text of `readings.csv` for the contacts in [`trace`]. In all readings, the height z has the error `by`.
fn readings(scale: f64, by: f64) -> String {
    let mut text = "finger,x_cm,y_cm,z_cm,normal_x,normal_y,normal_z\n".to_owned();
    for finger in 0..3 {
        for x in [-1.0, 1.0] {
            let (x, y) = (x * scale, (f64::from(finger) - 1.0) * scale);
            text += &format!("{finger},{x},{y},{by},0,0,1\n");
        }
    }
    text
}

fn made(tables: &[(&str, &str)]) -> Study {
    study(
        &(config(0.3, "") + PLOT),
        &cells("scene.estimator", &["penalised"]),
        tables,
    )
}

#[test]
fn readings_are_drawn_where_they_differ_and_tips_where_they_are_apart() {
    let trace_0 = trace(1.0, 0.0);
    let read = |by: f64| {
        let readings = readings(1.0, by);
        drawn(&made(&[
            ("trace.csv", &trace_0),
            ("readings.csv", &readings),
        ]))
    };
    assert_eq!(read(0.0), drawn(&made(&[("trace.csv", &trace_0)])));
    let noisy = read(0.125);
    shows(&noisy, &["reading"]);
    assert!(noisy.contains("the readings are off by 0.125 cm (rms)"));
    assert_eq!(count(&noisy, "circle", "#0072B2"), 5);
    shows(
        &drawn(&made(&[("trace.csv", &trace(1.0, 0.5))])),
        &["tip centre"],
    );
}

#[test]
fn patches_of_any_size_and_shape_are_drawn() {
    for scale in [0.0, 5e-324, 1e-9, 1e9, 1e99] {
        let (trace, readings) = (trace(scale, 0.0), readings(scale, scale));
        let svg = drawn(&made(&[("trace.csv", &trace), ("readings.csv", &readings)]));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{scale}");
    }
    let one = format!("{HEADER}0,1,2,3,0,0,0,1,2,3\n");
    assert!(drawn(&made(&[("trace.csv", &one)])).contains("1 finger with 1 contact each"));
}

#[test]
fn bad_tables_are_refused() {
    let good = trace(1.0, 0.0);
    refused(&made(&[]), &["trace.csv"]);
    for (trace, parts) in [
        (
            good.replace("normal_z", "normal_w"),
            &["trace.csv", "\"normal_z\""][..],
        ),
        (HEADER.to_owned(), &["trace.csv", "empty"]),
        (
            good.replace("0,-1,-1,0,", "0,1e101,-1,0,"),
            &["line 2", "x_cm", "1e101"],
        ),
    ] {
        refused(&made(&[("trace.csv", &trace)]), parts);
    }
    let stray = readings(1.0, 0.1).replace("\n2,", "\n7,");
    let tables = [("trace.csv", good.as_str()), ("readings.csv", &stray)];
    refused(
        &made(&tables),
        &["readings.csv", "line 6", "7", "finger of trace.csv"],
    );
}
