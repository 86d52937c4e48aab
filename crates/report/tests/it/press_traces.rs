//! Tests the figures of a single press.

use crate::fixture::{self, attribute};
use palpate_report::{Figure, Files, ReportError, press_figures};

const TRACE: &str = "marker,x_mm,y_mm,radial_position_mm,normal_displacement_mm,tangential_x_mm,tangential_y_mm\n\
    0,0,0,0,1,0,0\n\
    1,4,0,4,0.5,0.2,0\n\
    2,0,4,4,0.5,0,0.2\n\
    3,-4,0,4,0.5,-0.2,0\n\
    4,0,-4,4,0.5,0,-0.2\n";
/// Text of `readings.csv`. The markers are in another order than in `trace.csv`. The third marker has no reading. The
/// errors are ±0.1 mm along the normal, and 0.05 mm along the skin.
const READINGS: &str = "x_mm,y_mm,normal_displacement_mm,tangential_x_mm,tangential_y_mm\n\
    0,-4,0.6,0,-0.25\n\
    4,0,0.4,0.25,0\n\
    0,0,1.1,0.05,0\n\
    -4,0,0.6,-0.2,0.05\n";
const VERMILION: &str = "#D55E00";

fn press(trace: &str, readings: &str) -> Result<Vec<Figure>, ReportError> {
    press_figures(&Files::in_memory([
        ("trace.csv", trace),
        ("readings.csv", readings),
    ]))
}

#[track_caller]
fn drawn(trace: &str, readings: &str) -> [String; 2] {
    let figures = press(trace, readings).unwrap();
    let names: Vec<&str> = figures.iter().map(|figure| figure.name.as_str()).collect();
    assert_eq!(names, ["quiver", "trace-profile"]);
    [0, 1].map(|at| figures[at].svg.clone())
}

fn says(svg: &str, text: &str) -> bool {
    svg.contains(&format!("\n{text}\n"))
}

fn heights(svg: &str, colour: &str) -> Vec<f64> {
    let discs = svg
        .lines()
        .filter(|line| line.starts_with("<circle") && line.contains(colour));
    discs.map(|line| attribute(line, "cy") / 3.0).collect()
}

#[test]
fn missing_readings_are_not_drawn() {
    let normal_only = "x_mm,y_mm,normal_displacement_mm\n4,0,0.4\n";
    let [quiver, profile] = drawn(TRACE, normal_only);
    assert!(!says(&quiver, "reading") && says(&quiver, "no reading"));
    assert!(says(
        &quiver,
        "5 markers, 4 without a reading; rms error 0.1 mm inward."
    ));
    assert!(!profile.contains("along the skin"));
    assert!(says(&profile, "distance from the contact (mm)"));
    // These readings consist of the header only, so no marker has a reading.
    let [quiver, profile] = drawn(TRACE, READINGS.lines().next().unwrap());
    assert!(says(&quiver, "5 markers, 5 without a reading."));
    assert_eq!(heights(&profile, VERMILION).len(), 1);
    // In this table, no marker moves along the skin.
    let still = "marker,x,y,radial_position,normal_displacement,tangential_x,tangential_y\n\
        0,1,0,1,0.5,0,0\n";
    let [quiver, _] = drawn(still, "x,y,normal_displacement\n1,0,0.5\n");
    assert!(says(&quiver, "nothing along the skin") && says(&quiver, "x"));
    assert!(says(&quiver, "1 marker; rms error 0 inward."));
}

#[test]
fn presses_of_any_size_are_drawn() {
    for scale in ["0", "5e-324", "1e99"] {
        let trace = format!(
            "marker,x_um,y_um,radial_position_um,normal_displacement_um,tangential_x_um,tangential_y_um\n\
             0,0,0,0,{scale},0,{scale}\n1,{scale},-{scale},{scale},-{scale},{scale},0\n2,{scale},0,{scale},0,0,0\n"
        );
        let readings = format!(
            "x_um,y_um,normal_displacement_um,tangential_x_um,tangential_y_um\n\
             {scale},-{scale},{scale},0,{scale}\n0,0,0,0,-{scale}\n"
        );
        for picture in drawn(&trace, &readings) {
            assert!(
                !picture.contains("NaN") && !picture.contains("inf"),
                "{scale}"
            );
        }
    }
}

#[test]
fn bad_tables_are_refused() {
    let trace = |from: &str, to: &str| (TRACE.replace(from, to), READINGS.to_owned());
    let readings = |from: &str, to: &str| (TRACE.to_owned(), READINGS.replace(from, to));
    let header = TRACE.lines().next().unwrap();
    let once_each = [
        "readings.csv",
        "a place in trace.csv that has no other reading",
    ];
    for ((trace, readings), parts) in [
        (
            (header.to_owned(), READINGS.to_owned()),
            &["trace.csv", "empty"][..],
        ),
        (
            (TRACE.to_owned(), String::new()),
            &["readings.csv", "empty"],
        ),
        (
            readings("tangential_y", "tangential_z"),
            &["readings.csv", "\"tangential_y\""],
        ),
        (
            readings("_mm", "_cm"),
            &["readings.csv", "no column \"x_mm\""],
        ),
        (
            trace("y_mm\n", "y_um\n"),
            &["trace.csv", "no column \"tangential_y_mm\""],
        ),
        // Each reading must be at the position of a marker that has no other reading. The first table has a reading at
        // a position without a marker, and the second has two readings at the same marker.
        (readings("0,-4,", "0,-4.1,"), &once_each),
        (readings("0,-4,", "-4,0,"), &once_each),
    ] {
        let error = press(&trace, &readings).unwrap_err().to_string();
        fixture::says(&error, parts);
    }
    assert!(press_figures(&Files::in_folder("/nonexistent-folder")).is_err());
}
