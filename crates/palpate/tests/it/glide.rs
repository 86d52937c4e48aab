//! Tests `palpate run`, `trace` and `check` with glides, and `estimate glide` with traced readings.

use super::desk::{Desk, RUN_FILES, assert_close, edited, number_at};

/// Three fingers on a saddle. The study has two cells (combinations of settings): one without noise and one
/// with noise.
pub(crate) const GLIDE: &str = r#"name = "a-glide"
length_unit = "mm"
seed = 7
trials = 20
outputs = ["cells", "trace", "map"]

[scene]
kind = "glide"
probe = { kind = "sphere", radius = 4.0 }
object = { kind = "saddle", a = 0.01 }
motion = { finger_positions = [-15.0, 0.0, 15.0], inter_finger_distance = 10.0, patch_length = 30.0, contacts_per_finger = 10 }
noise = { position = { kind = "gaussian", fraction_of_ifd = 0.0 } }
evaluate = { grid = 5, half_width = 10.0, gaussian_threshold = 0.00005, mean_threshold = 0.003 }

[[sweep]]
path = "scene.noise.position.fraction_of_ifd"
values = [0, 0.05]
"#;

#[test]
fn a_run_writes_cells_trace_and_maps() {
    let desk = Desk::with(GLIDE);
    let ended = desk.palpate("run c.toml --out o");
    let printed = "a-glide: 2 cells, 21 trials, 0 failed -> o\n";
    assert_eq!((ended.status, ended.stdout.as_str()), (Some(0), printed));
    let tables = ["trace.csv", "readings.csv", "map.csv"];
    let mut names = [&RUN_FILES[..], &tables, &["warnings.txt", "warnings.json"]].concat();
    names.sort_unstable();
    assert_eq!(desk.names("o"), names);

    let cells = desk.table("o/cells.csv");
    assert_eq!(cells.rows.len(), 6);
    for (row, (quantity, unit)) in [
        ("gaussian_curvature", "1/mm^2"),
        ("mean_curvature", "1/mm"),
        ("class", "1"),
    ]
    .into_iter()
    .enumerate()
    {
        assert_eq!(
            (cells.text(row, "quantity"), cells.text(row, "unit")),
            (quantity, unit)
        );
        assert_eq!(cells.text(row, "truth").is_empty(), quantity != "class");
        assert_eq!(
            (cells.text(row, "trials"), cells.text(row + 3, "trials")),
            ("1", "20")
        );
    }
    assert!(cells.number(0, "rms_error") < 1e-12 && cells.number(1, "rms_error") < 1e-11);
    assert_eq!(cells.number(2, "mean"), 1.0);
    assert!(cells.number(4, "rms_error") > 1e-5 && cells.number(4, "coverage95") > 0.5);
    assert!(cells.number(5, "mean") > 0.9);

    let map = desk.table("o/map.csv");
    assert_eq!(map.rows.len(), 50);
    assert_eq!(map.header[..4], ["cell", "x_mm", "y_mm", "z_mm"]);
    // The map is sorted by x and then by y, so the second row differs from the first by one step along y.
    assert_close(map.number(1, "x_mm"), -10.0, 1e-9);
    assert_close(map.number(1, "y_mm"), -5.0, 1e-9);
    let middle = 12;
    assert_close(
        map.number(middle, "gaussian_curvature_per_mm2"),
        -4e-4,
        1e-9,
    );
    assert_close(map.number(middle, "k_max_per_mm"), 0.02, 1e-9);
    assert_close(map.number(middle, "k_max_y").abs(), 1.0, 1e-9);
    assert_eq!(map.text(middle, "class"), "minimal");
    assert_eq!(map.text(middle, "true_class"), "minimal");
    assert_eq!((map.text(0, "cell"), map.text(49, "cell")), ("0", "1"));
}

#[test]
fn estimates_from_a_trace_have_the_true_values() {
    let desk = Desk::with(GLIDE);
    let printed = desk.palpate("trace c.toml --out t").printed();
    assert_eq!(printed, "a-glide: 30 contacts of 3 fingers -> t\n");
    let truth = desk.table("t/trace.csv");
    assert_eq!(
        truth.header.join(","),
        "finger,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z,tip_x_mm,tip_y_mm,tip_z_mm"
    );
    for row in 0..30 {
        let number = |column: &str| truth.number(row, column);
        // The centre of the tip is in the plane in which the finger moves, but the tip touches the saddle beside this
        // plane.
        assert_eq!(number("tip_y_mm"), [-15.0, 0.0, 15.0][row / 10]);
        let [x, y, z] = ["x_mm", "y_mm", "z_mm"].map(number);
        assert!((z - 0.01 * (x * x - y * y)).abs() < 1e-9);
        for axis in ["x", "y", "z"] {
            let reach = number(&format!("tip_{axis}_mm")) - number(&format!("{axis}_mm"));
            assert!((reach - 4.0 * number(&format!("normal_{axis}"))).abs() < 1e-9);
        }
    }
    let estimate = |options: &str| desk.json(&format!("estimate glide {options}"));
    for method in ["penalised", "quadric"] {
        let json = estimate(&format!("t/readings.csv --method {method}"));
        assert_eq!(json["method"], method);
        assert_eq!(
            (&json["contacts"], &json["fingers"]),
            (&30.into(), &3.into())
        );
        for (name, value, unit) in [
            ("gaussian_curvature", -4e-4, "1/mm^2"),
            ("k_min", -0.02, "1/mm"),
            ("k_max", 0.02, "1/mm"),
        ] {
            assert_close(number_at(&json, &format!("/{name}/value")), value, 1e-6);
            assert_eq!(json[name]["unit"], unit);
        }
        assert!(number_at(&json, "/mean_curvature/value").abs() < 1e-8);
        assert_close(number_at(&json, "/direction_of_min/0").abs(), 1.0, 1e-9);
        assert_eq!(
            (&json["class"], &json["sign_class"]),
            (&"minimal".into(), &"saddle".into())
        );
    }

    desk.palpate("trace c.toml --out n --cell 1 --trial 3")
        .printed();
    assert_eq!(desk.read("n/trace.csv"), desk.read("t/trace.csv"));
    assert_ne!(desk.read("n/readings.csv"), desk.read("t/readings.csv"));
    let json = estimate("n/readings.csv --map m.csv --grid 6");
    let std = number_at(&json, "/gaussian_curvature/std");
    assert!((number_at(&json, "/gaussian_curvature/value") + 4e-4).abs() < 4.0 * std);
    assert_close(number_at(&json, "/noise/position_std/value"), 0.5, 0.3);
    let probabilities = json["class_probabilities"].as_object().unwrap();
    let sum: f64 = probabilities
        .values()
        .map(|one| one.as_f64().unwrap())
        .sum();
    assert_close(sum, 1.0, 1e-9);
    let regions = json["regions"].as_array().unwrap();
    let points: i64 = regions
        .iter()
        .map(|one| one["points"].as_i64().unwrap())
        .sum();
    assert_eq!(points, 36);
    let map = desk.table("m.csv");
    assert_eq!((map.rows.len(), map.header.len()), (36, 29));
}

#[test]
fn two_pass_has_no_standard_errors() {
    let desk = Desk::with(GLIDE);
    desk.palpate("trace c.toml --out t --cell 1 --trial 0")
        .printed();
    let json = desk.json("estimate glide t/readings.csv --method two-pass --map m.csv");
    assert!(json["gaussian_curvature"]["std"].is_null() && json["status"].is_string());
    assert!(json["class_probabilities"].is_null() && json["noise"].is_null());
    let map = desk.table("m.csv");
    assert_eq!(map.text(0, "mean_curvature_std_per_mm"), "");
    assert_eq!(map.text(0, "probability_flat"), "");
}

#[test]
fn check_prints_models_noise_and_estimator() {
    Desk::with(GLIDE).palpate("check c.toml").prints_all(&[
        "cells   2; 1 of them run a single trial",
        "contacts by Newton's method on the offset surface, tolerance 1e-12 (a round tip on a saddle has no closed form",
        "noise: Gaussian errors of x, y and z, drawn per contact",
        "ideal sensor: the contact, with its normal",
        "warning: `inter_finger_distance` is 10, but fingers are 15 apart",
        "penalised bicubic spline, penalty weight by robust generalised cross validation (gamma 1.4), noise estimated from the contacts",
    ]);
    let beyond = edited(GLIDE, "half_width = 10.0", "half_width = 16.0");
    Desk::with(&beyond)
        .palpate("check c.toml")
        .prints("warning: the grid extends beyond the contacts");
}

#[test]
fn a_warning_names_cells_without_a_map() {
    // Normals in random directions make every trial fail, so the cells have no map.
    let lost = edited(GLIDE, "values = [0, 0.05]", "values = [0, 1]").replace(
        "fraction_of_ifd = 0.0 } }",
        "fraction_of_ifd = 0.0 }, normal = { kind = \"gaussian\", std_deg = 90 } }",
    );
    let ended = Desk::with(&lost).palpate("run c.toml --out o");
    let warning = "warning: the map has no estimates, because trial 0 failed as `folded` (2 of 2 cells, the first is 0)\n";
    assert!(ended.stderr.contains(warning), "{}", ended.stderr);
    assert!(ended.stderr.contains("\nerror: every trial failed: "));
    assert_eq!(ended.status, Some(1));
}

/// A study of fingertips of radius 4 mm on a ball of radius 20 mm. The sensor reports the lowest points of the tips.
const ROUND: &str = r#"name = "round-tips"
length_unit = "mm"
seed = 7
trials = 1
outputs = ["cells", "trace"]

[scene]
kind = "glide"
probe = { kind = "sphere", radius = 4.0 }
object = { kind = "sphere", radius = 20.0 }
motion = { finger_positions = [-5.0, 0.0, 5.0], inter_finger_distance = 5.0, patch_length = 10.0, contacts_per_finger = 10 }
sensor = { kind = "ideal", reports = "lowest-point" }
evaluate = { grid = 5, half_width = 3.0, gaussian_threshold = 0.00005, mean_threshold = 0.003 }
"#;

#[test]
fn the_tip_radius_is_subtracted_from_lowest_points_and_centres() {
    let desk = Desk::with(ROUND);
    desk.palpate("run c.toml --out o").printed();
    let cells = desk.table("o/cells.csv");
    assert_close(cells.number(1, "mean"), 0.05, 2e-3);
    let mean = |flags: &str| {
        let estimate = desk.json(&format!("estimate glide o/readings.csv {flags}"));
        number_at(&estimate, "/mean_curvature/value")
    };
    // Without the correction for the tip radius of 4 mm, the ball of radius 20 mm seems to have a radius of 24 mm. The
    // tolerances allow for the error of the smoothing spline.
    assert_close(mean(""), 1.0 / 24.0, 1e-2);
    assert_close(mean("--tip-radius 4"), 0.05, 1e-2);
    assert_close(
        mean("--tip-radius 4 --reports lowest-point --outward 0,0,2"),
        0.05,
        1e-2,
    );
    assert_close(mean("--like c.toml"), 0.05, 1e-2);
    // The centres of the tips are higher than the lowest points by the tip radius. This shift of all points does not
    // change the curvature.
    assert_close(mean("--tip-radius 4 --reports centre"), 0.05, 1e-2);
}
