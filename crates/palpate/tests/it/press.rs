//! Tests `palpate run`, `trace` and `check` with presses, and `estimate press` with traced readings.

use serde_json::Value;

use super::desk::{Desk, RUN_FILES, assert_close, edited};
use palpate::Warning;

/// A study of presses on a ball, a plane, a dish, and a dish with a smaller radius than the sensor.
pub(crate) const PRESS: &str = r#"name = "a-press"
length_unit = "mm"
seed = 7
trials = 40
outputs = ["cells", "trace", "map"]

[scene]
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }
object = { kind = "plane" }
motion = { indentation = 1.0 }
noise = { normal_displacement = { kind = "gaussian", std = 0.05 }, tangential_displacement = { kind = "gaussian", std = 0.02 }, indentation = { kind = "gaussian", std = 0.02 } }
estimator = { kind = "half-space", indentation_std = 0.02 }

[[sweep]]
path = "scene.object"
values = [{ label = "ball", kind = "sphere", radius = 30 }, { label = "plane", kind = "plane" }, { label = "dish", kind = "dish", radius = 80 }, { label = "cup", kind = "dish", radius = 10 }]
"#;

fn json(desk: &Desk, arguments: &str) -> Value {
    desk.json(&format!("estimate press {arguments}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

#[test]
fn a_run_writes_cells_trace_and_profiles() {
    let desk = Desk::with(PRESS);
    let ended = desk.palpate("run c.toml --out o");
    assert_eq!(
        (ended.status, ended.stdout.as_str()),
        (
            Some(0),
            "a-press: 4 cells, 160 trials, 40 failed (edge-contact 40) -> o\n"
        )
    );
    assert_eq!(
        ended.stderr,
        "warning: no press; every trial fails as `edge-contact`: the relative curvature is -0.05, below 0: the sensor \
         touches the edge of the object (cell 3)\n\
         warning: the map has no estimates, because trial 0 failed as `edge-contact` (cell 3)\n"
    );
    let warnings: Vec<Warning> = serde_json::from_str(&desk.read("o/warnings.json")).unwrap();
    let codes = warnings.iter().map(|warning| warning.code.as_str());
    assert!(codes.eq(["failed-map", "no-press"]), "{warnings:?}");
    assert_eq!(warnings[0].numbers["first_cell"], 3.0);
    let lines: String = warnings
        .iter()
        .map(|warning| format!("{warning}\n"))
        .collect();
    assert_eq!(desk.read("o/warnings.txt"), lines);

    let others = [
        "trace.csv",
        "readings.csv",
        "map.csv",
        "warnings.json",
        "warnings.txt",
    ];
    let mut names = [&RUN_FILES[..], &others].concat();
    names.sort_unstable();
    assert_eq!(desk.names("o"), names);

    let cells = desk.table("o/cells.csv");
    assert_eq!(cells.header.last().unwrap(), "std_bound");
    // The plane has no finite radius, so its cell has 6 rows instead of 7.
    assert_eq!(cells.rows.len(), 7 + 6 + 7 + 7);
    for (row, (quantity, unit, truth)) in [
        ("relative_curvature", "1/mm", 1.0 / 12.0),
        ("effective_radius", "mm", 12.0),
        ("object_curvature", "1/mm", 1.0 / 30.0),
        ("indentation", "mm", 1.0),
        ("contact_radius", "mm", 12.0_f64.sqrt()),
        ("r_squared", "1", 1.0),
        ("object_radius", "mm", 30.0),
    ]
    .into_iter()
    .enumerate()
    {
        assert_eq!(
            (cells.text(row, "quantity"), cells.text(row, "unit")),
            (quantity, unit)
        );
        assert_close(cells.number(row, "truth"), truth, 1e-12);
        assert_eq!(cells.text(row, "trials"), "40");
        assert_eq!(
            cells.text(row, "std_bound").is_empty(),
            quantity == "r_squared"
        );
        assert_eq!(
            cells.text(row, "coverage95").is_empty(),
            quantity == "r_squared"
        );
    }
    let std = cells.number(0, "std");
    assert_close(std, cells.number(0, "std_bound"), 0.35);
    assert!(cells.number(0, "coverage95") > 0.8);
    let dish = cells.row_of(2, "object_radius");
    assert_eq!(cells.number(dish, "truth"), -80.0);
    let cup = cells.row_of(3, "effective_radius");
    assert_eq!(
        (cells.text(cup, "failures"), cells.text(cup, "truth")),
        ("40", "")
    );
    assert_eq!(
        desk.read("o/failures.csv"),
        "cell,kind,count,first_trial\n3,edge-contact,40,0\n"
    );

    let map = desk.table("o/map.csv");
    assert_eq!(
        map.header.join(","),
        "cell,radial_position_mm,normal_displacement_mm,radial_displacement_mm,\
         estimated_normal_displacement_mm,estimated_radial_displacement_mm"
    );
    assert_eq!(map.rows.len(), 3 * 121);
    assert_close(
        map.number(120, "radial_position_mm"),
        3.0 * 12.0_f64.sqrt(),
        1e-12,
    );
    // On a half-space with the effective radius 20 and the indentation 1, the normal displacement at the depth 2 under
    // the centre of the contact is 0.87.
    let middle = map.number(121, "normal_displacement_mm");
    assert!((0.8..0.875).contains(&middle), "{middle}");
    assert_close(
        map.number(121, "estimated_normal_displacement_mm"),
        middle,
        0.1,
    );
}

#[test]
fn estimates_from_a_trace_have_the_true_values() {
    let desk = Desk::with(PRESS);
    desk.palpate("trace c.toml --out t --cell 2").printed();
    for options in [
        "--indentation 1",
        "",
        "--baseline fitted",
        "--indentation 1 --gain-std 0.1",
    ] {
        let estimate = json(
            &desk,
            &format!("t/readings.csv --sensor-radius 20 --depth 2 {options}"),
        );
        for (name, value, unit) in [
            ("relative_curvature", 0.0375, "1/mm"),
            ("effective_radius", 1.0 / 0.0375, "mm"),
            ("object_curvature", -0.0125, "1/mm"),
            ("object_radius", -80.0, "mm"),
            ("indentation", 1.0, "mm"),
            ("contact_radius", libm::pow(0.0375_f64, -0.5), "mm"),
        ] {
            assert_close(number(&estimate[name]["value"]), value, 1e-5);
            assert_eq!(estimate[name]["unit"], unit);
        }
        assert_eq!(
            (&estimate["verdict"], &estimate["regime"]),
            (&"concave".into(), &"concave".into())
        );
        assert!(estimate["object_radius"]["convex95"].is_null());
    }

    // A press without a valid contact cannot be traced.
    let said = desk.palpate("trace c.toml --out e --cell 3").said(1);
    assert_eq!(
        said,
        "error: the relative curvature is -0.05, below 0: the sensor touches the edge of the object\n"
    );
    assert!(desk.names("e").is_empty());
}

#[test]
fn normal_displacements_alone_or_of_one_row_are_enough() {
    let normal = edited(
        PRESS,
        "estimator",
        "sensor = { kind = \"direct\", tangential = false }\nestimator",
    );
    let desk = Desk::with(&normal);
    desk.palpate("trace c.toml --out t").printed();
    assert_eq!(
        desk.table("t/readings.csv").header.join(","),
        "x_mm,y_mm,normal_displacement_mm"
    );
    let estimate = json(
        &desk,
        "t/readings.csv --sensor-radius 20 --depth 2 --indentation 1",
    );
    assert_close(number(&estimate["object_radius"]["value"]), 30.0, 1e-5);
    assert!(estimate["noise"]["tangential_std"].is_null());

    let row = edited(
        &normal,
        "marker_depth = 2.0",
        "marker_depth = 2.0, layout = { kind = \"line\", markers = 21, length = 30 }",
    );
    let row = edited(
        &row,
        "indentation = 1.0",
        "indentation = 1.0, contact_deg = [6, 0]",
    );
    let desk = Desk::with(&row);
    desk.palpate("trace c.toml --out t").printed();
    // The positions in this file are too small by the factor 2.19, as if they were in another unit. `--radial-scale`
    // multiplies them by this factor.
    let readings = desk.table("t/readings.csv");
    let mut text = "radial_position_mm,normal_displacement_mm\n".to_owned();
    for one in 0..readings.rows.len() {
        let position = readings.number(one, "x_mm") / 2.19;
        text += &format!(
            "{position},{}\n",
            readings.text(one, "normal_displacement_mm")
        );
    }
    desk.write("row.csv", &text);
    let options = "--sensor-radius 20 --depth 2 --indentation 1 --radial-scale 2.19";
    let estimate = json(&desk, &format!("row.csv {options}"));
    assert_close(number(&estimate["object_radius"]["value"]), 30.0, 1e-5);
    assert_close(
        number(&estimate["contact"][0]),
        20.0 * 6.0_f64.to_radians(),
        1e-5,
    );
    assert!(number(&estimate["contact"][1]).abs() < 1e-9);
}

#[test]
fn forces_follow_from_a_modulus() {
    let desk = Desk::with(PRESS);
    desk.palpate("trace c.toml --out t --cell 1").printed();
    let estimate = |options: &str| {
        json(
            &desk,
            &format!("t/readings.csv --sensor-radius 20 --depth 2 --indentation 1 {options}"),
        )
    };
    let press = estimate("--young 0.3");
    // The expected force is (4/3) E* √R δ^1.5, and the highest pressure is (2 E*/π) √(δ/R). R is the effective radius,
    // δ the indentation, and E* = E/(1 − ν²) with Young's modulus E and Poisson's ratio ν = 1/2.
    assert_close(
        number(&press["force"]["value"]),
        4.0 / 3.0 * 0.4 * 20.0_f64.sqrt(),
        1e-5,
    );
    assert_eq!(press["force"]["unit"], "unit of young x mm^2");
    let pressure = 0.8 / std::f64::consts::PI / 20.0_f64.sqrt();
    assert_close(number(&press["peak_pressure"]["value"]), pressure, 1e-5);
    assert!(estimate("")["force"].is_null());
}

#[test]
fn outliers_are_named_by_row_and_line() {
    let desk = Desk::with(PRESS);
    desk.palpate("trace c.toml --out t --trial 1").printed();
    let readings = desk.read("t/readings.csv");
    for (outliers, value) in [
        (&[3, 20][..], "-1.5"),
        (&[3, 9, 16, 20, 27, 33, 40, 48, 55, 62, 70, 75], "-1"),
    ] {
        let mut lines: Vec<String> = readings.lines().map(str::to_owned).collect();
        for &line in outliers {
            let mut fields: Vec<&str> = lines[line].split(',').collect();
            fields[2] = value;
            lines[line] = fields.join(",");
        }
        // A blank line does not count as a row of the table.
        lines.insert(10, String::new());
        desk.write("r.csv", lines.join("\n"));
        let estimate = json(
            &desk,
            "r.csv --sensor-radius 20 --depth 2 --indentation 1 --indentation-std 0.02 --normal-std 0.05 --tangential-std 0.02",
        );
        let row =
            |&row: &usize| serde_json::json!({ "row": row, "line": row + 1 + (row / 10).min(1) });
        let rows: Vec<Value> = outliers.iter().map(row).collect();
        assert_eq!(estimate["wrong_markers"], Value::from(rows));
        let curvature = &estimate["object_curvature"];
        let deviation = number(&curvature["value"]) - 1.0 / 30.0;
        assert!(deviation.abs() < 4.0 * number(&curvature["std"]));
    }
}

#[test]
fn a_gaussian_is_calibrated_on_a_plane() {
    let gaussian = edited(
        PRESS,
        r#"{ kind = "half-space", indentation_std = 0.02 }"#,
        r#"{ kind = "gaussian" }"#,
    );
    // The row of markers has 60 markers on each side of the apex, up to a distance of twice the contact radius.
    let gaussian = edited(
        &gaussian,
        "marker_depth = 2.0",
        "marker_depth = 2.0, layout = { kind = \"line\", markers = 121, length = 17.88854382 }",
    );
    let noiseless: String = gaussian
        .lines()
        .filter(|line| !line.starts_with("noise"))
        .map(|line| format!("{line}\n"))
        .collect();
    let desk = Desk::with(&noiseless);
    desk.palpate("run c.toml --out o");
    let cells = desk.table("o/cells.csv");
    assert_close(
        cells.number(cells.row_of(1, "effective_radius"), "mean"),
        20.0,
        1e-6,
    );
    assert!(cells.text(0, "std_bound").is_empty());
    let map = desk.table("o/map.csv");
    assert!(map.text(5, "estimated_radial_displacement_mm").is_empty());
    // `palpate estimate press` calibrates the constant c of the method `gaussian` in the same way as the study.
    desk.palpate("trace c.toml --out t --cell 1").printed();
    let estimate = json(
        &desk,
        "t/readings.csv --sensor-radius 20 --depth 2 --method gaussian --indentation 1",
    );
    assert_close(number(&estimate["effective_radius"]["value"]), 20.0, 1e-6);
    let c = number(&estimate["c"]);
    // Reference values from another program: an unweighted fit of the Gaussian gives width²/indentation = 22.7 and a
    // coefficient of determination of 0.978.
    assert_close(c, 20.0 / 22.7, 0.005);
    assert_close(number(&estimate["r_squared"]), 0.978, 0.001);
    let paper = json(
        &desk,
        "t/readings.csv --sensor-radius 20 --depth 2 --method gaussian --indentation 1 --c 1",
    );
    assert_close(number(&paper["effective_radius"]["value"]), 20.0 / c, 1e-6);
}

#[test]
fn the_example_readings_match_their_description() {
    let example = |name: &str| {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        std::fs::read_to_string(root.join(name)).unwrap()
    };
    let desk = Desk::with(&example("press-a-ball.toml"));
    desk.palpate("trace c.toml --out t --cell 10 --trial 0")
        .printed();
    desk.write("r.csv", example("press-readings.csv"));
    let (traced, kept) = (desk.table("t/readings.csv"), desk.table("r.csv"));
    assert_eq!(
        (&traced.header, traced.rows.len()),
        (&kept.header, kept.rows.len())
    );
    for (traced, kept) in traced.rows.iter().zip(&kept.rows) {
        for (traced, kept) in traced.iter().zip(kept) {
            let [traced, kept] = [traced, kept].map(|text| text.parse::<f64>().unwrap());
            assert!((traced - kept).abs() < 1e-5);
        }
    }
    let estimate = json(
        &desk,
        "r.csv --sensor-radius 20 --depth 2 --indentation 1.5 --indentation-std 0.02",
    );
    let ends = &estimate["object_radius"]["convex95"];
    assert!(
        number(&ends[0]) < 30.0 && number(&ends[1]) > 30.0,
        "{estimate}"
    );
    for name in ["dish", "plane"] {
        desk.write(
            "p.csv",
            example(&format!("chromatouch-2020/profile-{name}.csv")),
        );
        let options = "--sensor-radius 20 --depth 2 --indentation 1 --radial-scale 2.19";
        let estimate = json(&desk, &format!("p.csv {options}"));
        assert_eq!(estimate["markers"], 11);
        assert!(number(&estimate["r_squared"]) > 0.85, "{estimate}");
    }
}

#[test]
fn a_press_measured_by_one_marker_alone_causes_a_warning() {
    let desk = Desk::new();
    let mut readings = "x,y,normal_displacement\n".to_owned();
    for marker in 0..36 {
        let [x, y] = [marker / 6, marker % 6].map(|step| 4 * step - 10);
        let moved = if marker == 14 {
            0.5
        } else {
            0.01 * libm::sin(7.0 * f64::from(marker))
        };
        readings += &format!("{x},{y},{moved:.4}\n");
    }
    desk.write("slip.csv", readings);
    let layer = "--sensor-radius 20 --length-unit mm --method bonded-layer --thickness 4 --depth 2";
    let said = desk.palpate(&format!(
        "estimate press slip.csv {layer} --noise stated --normal-std 0.02"
    ));
    assert_eq!(said.status, Some(0), "{said:?}");
    let warning = "warning: only the marker of row 15, line 16 moved: it is wrong, or";
    assert!(said.stderr.contains(warning), "{said:?}");
}

#[test]
fn scenes_may_have_a_flat_pad() {
    let sphere = "radius = 20.0, marker_depth = 2.0";
    let pad = |layout: &str| {
        edited(
            PRESS,
            sphere,
            &format!("radius = inf, marker_depth = 0.5{layout}"),
        )
    };
    let grid = ", layout = { kind = \"grid\", pitch = 2, width = 24, height = 20 }";
    let desk = Desk::with(&pad(grid));
    let run = |line: &str| {
        let ended = desk.palpate(line).stdout;
        assert!(
            ended.contains("failed (conforming 40, edge-contact 80)"),
            "{ended}"
        );
    };
    run("run c.toml --out o");
    // The config that this run wrote describes the same flat pad, so another run with it prints the same numbers.
    run("run o/run.toml --out again");
    desk.palpate("trace c.toml --cell 0 --trial 0 --out t")
        .printed();
    for options in ["--sensor-radius inf --depth 0.5", "--like c.toml --cell 0"] {
        let curvature = &json(&desk, &format!("t/readings.csv {options}"))["object_curvature"];
        let [low, high] = [0, 1].map(|end| number(&curvature["interval95"][end]));
        assert!(
            low < 1.0 / 30.0 && 1.0 / 30.0 < high,
            "{options}: {curvature}"
        );
    }
    let moved = |motion: &str| edited(&pad(grid), "motion = {", motion);
    for (config, words) in [
        (pad(""), "scene.probe.layout: needs a skin with a radius"),
        (
            moved("sensor = { kind = \"projected\" }\nmotion = {"),
            "a camera is in the centre of the sensor's sphere",
        ),
        (
            moved("motion = { contact_deg = [10, 0],"),
            "must be 0 on a flat pad",
        ),
    ] {
        desk.write("c.toml", config);
        desk.palpate("check c.toml").fails(2, words);
    }
}
