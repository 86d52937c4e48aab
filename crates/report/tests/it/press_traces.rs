//! The pictures of one press.

use palpate_report::{ReportError, draw_press_trace};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const TRACE: &str = "marker,x_mm,y_mm,radial_position_mm,normal_displacement_mm,tangential_x_mm,tangential_y_mm\n\
    0,0,0,0,1,0,0\n\
    1,4,0,4,0.5,0.2,0\n\
    2,0,4,4,0.5,0,0.2\n\
    3,-4,0,4,0.5,-0.2,0\n\
    4,0,-4,4,0.5,0,-0.2\n";
/// The third marker is lost, the others come in another order; off by 0.1 inward, by 0.05 along the skin.
const READINGS: &str = "x_mm,y_mm,normal_displacement_mm,tangential_x_mm,tangential_y_mm\n\
    0,-4,0.6,0,-0.25\n\
    4,0,0.4,0.25,0\n\
    0,0,1.1,0.05,0\n\
    -4,0,0.6,-0.2,0.05\n";

const BLUE: &str = "#0072B2";
const VERMILION: &str = "#D55E00";

fn folder(trace: &str, readings: &str) -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("trace.csv"), trace).unwrap();
    fs::write(dir.path().join("readings.csv"), readings).unwrap();
    dir
}

/// The quiver and the profile, as SVG.
#[track_caller]
fn drawn(trace: &str, readings: &str) -> [String; 2] {
    let dir = folder(trace, readings);
    draw_press_trace(dir.path()).unwrap();
    ["quiver", "trace-profile"].map(|name| svg(dir.path(), name))
}

fn svg(dir: &Path, name: &str) -> String {
    fs::read_to_string(dir.join(format!("{name}.svg"))).unwrap()
}

fn says(svg: &str, text: &str) -> bool {
    svg.contains(&format!("\n{text}\n"))
}

/// Elements of a colour.
fn count(svg: &str, element: &str, colour: &str) -> usize {
    let of = |line: &&str| line.starts_with(element) && line.contains(colour);
    svg.lines().filter(of).count()
}

/// Middle heights of the discs of a colour, in pixels.
fn heights(svg: &str, colour: &str) -> Vec<f64> {
    let discs = svg
        .lines()
        .filter(|line| line.starts_with("<circle") && line.contains(colour));
    let height = |line: &str| {
        let y = line.split("cy=\"").nth(1).unwrap();
        y.split('"').next().unwrap().parse::<f64>().unwrap() / 3.0
    };
    discs.map(height).collect()
}

#[test]
fn four_files_are_written_and_returned() {
    let dir = folder(TRACE, READINGS);
    let written = draw_press_trace(dir.path()).unwrap();
    let names = [
        "quiver.svg",
        "quiver.png",
        "trace-profile.svg",
        "trace-profile.png",
    ];
    assert_eq!(written, names.map(|name| dir.path().join(name)));
    let read = |path: &PathBuf| fs::read(path).unwrap();
    assert!(read(&written[1]).starts_with(b"\x89PNG") && read(&written[3]).starts_with(b"\x89PNG"));
    let first: Vec<Vec<u8>> = written.iter().map(read).collect();
    draw_press_trace(dir.path()).unwrap();
    assert_eq!(first, written.iter().map(read).collect::<Vec<_>>());
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 6);
}

#[test]
fn the_quiver_has_arrows_a_scale_shades_and_marks_what_is_lost() {
    let [quiver, _] = drawn(TRACE, READINGS);
    for text in [
        // rms of 0.05 along the skin: three markers are off by it, and the last by hypot(0, 0.05).
        "5 markers, 1 without a reading · rms error 0.1 mm inward, 0.05 mm along the skin",
        "x (mm)",
        "y (mm)",
        "truth",
        "reading",
        "0.2 mm",
        "inward, truth (mm)",
        "no reading",
    ] {
        assert!(says(&quiver, text), "{text}");
    }
    // A shaft each and one in the key: true ones of four markers, read ones of four.
    assert_eq!(count(&quiver, "<polyline", BLUE), 5);
    assert_eq!(count(&quiver, "<polyline", VERMILION), 5);
    // Their heads, and the two bars of a cross on the lost one and in the key.
    assert_eq!(count(&quiver, "<polygon", BLUE), 5);
    assert_eq!(count(&quiver, "<polygon", VERMILION), 5 + 4);
}

#[test]
fn the_profile_has_both_components_true_and_read() {
    let [_, profile] = drawn(TRACE, READINGS);
    for text in [
        "displacement inward (mm)",
        "displacement along the skin, outward (mm)",
        "distance from the contact (mm)",
        "truth",
        "reading",
    ] {
        assert!(says(&profile, text), "{text}");
    }
    // Dashes: five inward, four along the skin (at the contact nothing is outward), one in the legend.
    assert_eq!(count(&profile, "<polygon", BLUE), 5 + 4 + 1);
    let dots = heights(&profile, VERMILION);
    assert_eq!(dots.len(), 4 + 3 + 1);
    // Legend, or in the order of the markers inward: 1.1, 0.4, 0.6, 0.6; then outward: 0.25, 0.2, 0.25.
    let along: Vec<f64> = dots.iter().copied().filter(|y| *y > 600.0).collect();
    let [a, b, c] = along[..] else {
        panic!("{dots:?}")
    };
    assert!(a < b && (a - c).abs() < 0.5, "{along:?}");
    let inward: Vec<f64> = dots.iter().copied().filter(|y| *y < 600.0).collect();
    assert!(inward[0] < inward[2] && inward[2] < inward[1], "{inward:?}");
}

#[test]
fn what_is_not_read_is_not_drawn() {
    let normal_only = "x_mm,y_mm,normal_displacement_mm\n4,0,0.4\n";
    let [quiver, profile] = drawn(TRACE, normal_only);
    assert!(!says(&quiver, "reading") && says(&quiver, "no reading"));
    assert!(says(
        &quiver,
        "5 markers, 4 without a reading · rms error 0.1 mm inward"
    ));
    assert!(!profile.contains("along the skin"));
    assert!(says(&profile, "distance from the contact (mm)"));
    // No marker was found at all.
    let [quiver, profile] = drawn(TRACE, READINGS.lines().next().unwrap());
    assert!(says(&quiver, "5 markers, 5 without a reading"));
    assert_eq!(heights(&profile, VERMILION).len(), 1);
    // Nothing moves along the skin.
    let still = "marker,x,y,radial_position,normal_displacement,tangential_x,tangential_y\n\
        0,1,0,1,0.5,0,0\n";
    let [quiver, _] = drawn(still, "x,y,normal_displacement\n1,0,0.5\n");
    assert!(says(&quiver, "nothing along the skin") && says(&quiver, "x"));
    assert!(says(&quiver, "1 marker · rms error 0 inward"));
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

#[track_caller]
fn refused(trace: &str, readings: &str, parts: &[&str]) {
    let dir = folder(trace, readings);
    let error: ReportError = draw_press_trace(dir.path()).unwrap_err();
    let error = error.to_string();
    for part in parts {
        assert!(error.contains(part), "{part:?} is not in: {error}");
    }
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
}

#[test]
fn bad_tables_are_refused() {
    let header = TRACE.lines().next().unwrap();
    refused(header, READINGS, &["trace.csv", "empty"]);
    refused(TRACE, "", &["readings.csv", "empty"]);
    refused(
        &TRACE.replace("radial_position", "radius"),
        READINGS,
        &["trace.csv", "\"radial_position\""],
    );
    refused(
        TRACE,
        &READINGS.replace("tangential_y", "tangential_z"),
        &["readings.csv", "\"tangential_y\""],
    );
    refused(
        &TRACE.replace("0,0,0,0,1,", "0,0,0,0,NaN,"),
        READINGS,
        &["line 2", "normal_displacement_mm", "NaN"],
    );
    refused(
        TRACE,
        &READINGS.replace("_mm", "_cm"),
        &["readings.csv", "no column \"x_mm\""],
    );
    refused(
        &TRACE.replace("tangential_y_mm", "tangential_y_um"),
        READINGS,
        &["trace.csv", "no column \"tangential_y_mm\""],
    );
    // A place where no marker is, and a marker read twice.
    for other in ["0,-4.1", "-4,0"] {
        refused(
            TRACE,
            &READINGS.replace("0,-4,", &format!("{other},")),
            &[
                "readings.csv",
                "place of a marker of trace.csv, once for each",
            ],
        );
    }
    assert!(draw_press_trace(Path::new("/nonexistent-folder")).is_err());
}
