//! The picture of contacts in space.

use crate::glides::{cells, config, study};
use palpate_report::{Study, page, plot};
use std::fs;
use tempfile::TempDir;

const PLOT: &str =
    "[[plot]]\nname = \"contacts\"\nkind = \"contacts\"\ntitle = \"Three fingers\"\n";
const HEADER: &str =
    "finger,x_cm,y_cm,z_cm,normal_x,normal_y,normal_z,tip_x_cm,tip_y_cm,tip_z_cm\n";

/// Three fingers on the plane z = 0, `scale` apart, two contacts each, tips of radius `tip`.
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

/// Readings of [`trace`] that are too high by `by`.
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

fn made(tables: &[(&str, &str)]) -> (TempDir, Study) {
    study(
        &(config(0.3, "") + PLOT),
        &cells("scene.estimator", &["penalised"]),
        tables,
    )
}

/// The picture as it stands in the page.
fn drawn(tables: &[(&str, &str)]) -> String {
    let html = page(&[made(tables).1]).unwrap();
    let (from, to) = (html.find("<svg").unwrap(), html.find("</svg>").unwrap());
    html[from..to].to_owned()
}

#[track_caller]
fn refused(tables: &[(&str, &str)], parts: &[&str]) {
    let error = plot(&made(tables).1).unwrap_err().to_string();
    for part in parts {
        assert!(error.contains(part), "{part:?} is not in: {error}");
    }
}

/// Discs of a colour: contacts, and the sample in the key.
fn discs(svg: &str, colour: &str) -> usize {
    svg.lines()
        .filter(|line| line.starts_with("<circle") && line.contains(colour))
        .count()
}

#[test]
fn contacts_normals_and_axes_are_drawn() {
    let svg = drawn(&[("trace.csv", &trace(1.0, 0.0))]);
    for text in [
        "Three fingers",
        "saddle, a = 0.3 · 3 fingers, 2 contacts each",
        "finger 0",
        "finger 2",
        "normal",
        "x (cm)",
        "y (cm)",
        "z (cm)",
    ] {
        assert!(svg.contains(&format!("\n{text}\n")), "{text}");
    }
    assert!(!svg.contains("reading") && !svg.contains("tip"));
    // The first three of the Okabe–Ito colours.
    for colour in ["#0072B2", "#D55E00", "#009E73"] {
        assert_eq!(discs(&svg, colour), 3, "{colour}");
    }
}

#[test]
fn readings_are_drawn_where_they_differ_and_tips_where_they_are_apart() {
    let trace_0 = trace(1.0, 0.0);
    let same = drawn(&[
        ("trace.csv", &trace_0),
        ("readings.csv", &readings(1.0, 0.0)),
    ]);
    assert_eq!(same, drawn(&[("trace.csv", &trace_0)]));
    let noisy = drawn(&[
        ("trace.csv", &trace_0),
        ("readings.csv", &readings(1.0, 0.125)),
    ]);
    assert!(noisy.contains("\nreading\n") && noisy.contains("readings off by 0.125 cm rms"));
    assert_eq!(discs(&noisy, "#0072B2"), 5);
    let round = drawn(&[("trace.csv", &trace(1.0, 0.5))]);
    assert!(round.contains("\ntip centre\n"));
}

#[test]
fn patches_of_any_size_and_shape_are_drawn() {
    for scale in [0.0, 5e-324, 1e-9, 1e9, 1e99] {
        let svg = drawn(&[
            ("trace.csv", &trace(scale, 0.0)),
            ("readings.csv", &readings(scale, scale)),
        ]);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{scale}");
    }
    let one = format!("{HEADER}0,1,2,3,0,0,0,1,2,3\n");
    assert!(drawn(&[("trace.csv", &one)]).contains("1 finger, 1 contact each"));
}

#[test]
fn the_picture_is_written_as_png_too() {
    let (dir, study) = made(&[("trace.csv", &trace(1.0, 0.0))]);
    let names = ["contacts.svg", "contacts.png"].map(|name| dir.path().join(name));
    assert_eq!(plot(&study).unwrap(), names);
    assert!(fs::read(&names[1]).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn bad_tables_are_refused() {
    let good = trace(1.0, 0.0);
    refused(&[], &["trace.csv"]);
    refused(
        &[("trace.csv", &good.replace("normal_z", "normal_w"))],
        &["trace.csv", "\"normal_z\""],
    );
    refused(&[("trace.csv", HEADER)], &["trace.csv", "empty"]);
    refused(
        &[("trace.csv", &good.replace("0,-1,-1,0,", "0,-1,-1,inf,"))],
        &["line 2", "z_cm", "inf"],
    );
    refused(
        &[("trace.csv", &good.replace("0,-1,-1,0,", "0,1e101,-1,0,"))],
        &["line 2", "x_cm", "1e101"],
    );
    let stray = readings(1.0, 0.1).replace("\n2,", "\n7,");
    refused(
        &[("trace.csv", &good), ("readings.csv", &stray)],
        &["readings.csv", "line 6", "7", "finger of trace.csv"],
    );
}
