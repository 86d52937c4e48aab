//! Tests figures of kind `profile`, reference points and lower bounds: their lines and texts, and input that is
//! rejected.

use crate::fixture::{Cells, Numbers, drawn, refused};
use crate::presses::{OBJECTS, config};
use palpate_report::Study;

const PROFILE: &str = "[[plot]]\nname = \"p\"\nkind = \"profile\"\n";
const LINES: &str = "[[plot]]\nname = \"p\"\nx = \"scene.motion.indentation\"\ny = \"std\"\n\
    series = \"scene.object\"\n";
const HEADER: &str = "cell,radial_position_mm,normal_displacement_mm,radial_displacement_mm,\
    estimated_normal_displacement_mm,estimated_radial_displacement_mm\n";
const POINTS: &str = "[[plot.points]]\nlabel = \"published\"\n";
fn cells() -> Cells {
    let mut cells = Cells::new("scene.object,scene.estimator");
    for (object, ..) in OBJECTS {
        for estimator in ["half-space", "gaussian"] {
            let numbers = Numbers {
                trials: 1,
                ..Numbers::default()
            };
            cells.push_of(
                &format!("{object},{estimator}"),
                "r_squared,1/mm",
                numbers,
                "",
            );
        }
    }
    cells
}

/// Text of `map.csv` with three positions per cell. The true values differ between objects, the estimates differ
/// between all cells.
fn map() -> String {
    let mut text = HEADER.to_owned();
    for cell in 0..6_u8 {
        for r in 0..3_u8 {
            let (r, object) = (f64::from(r), f64::from(cell / 2));
            let truth = (1.0 + 0.1 * object) / (1.0 + r);
            let estimate = truth + 0.01 * f64::from(cell + 1);
            let radial = if cell % 2 == 0 {
                (0.2 * estimate).to_string()
            } else {
                String::new()
            };
            text += &format!("{cell},{r},{truth},{},{estimate},{radial}\n", -0.1 * truth);
        }
    }
    text
}

fn made(plots: &str, map: &str) -> Study {
    cells().study_with(&config("[]", plots), map)
}

#[test]
fn bad_profiles_are_refused() {
    refused(&cells().study(&config("[]", PROFILE)), &["map.csv"]);
    for (from, to, parts) in [
        (
            "radial_position",
            "radius",
            &["map.csv", "\"radial_position\"", "radius_mm"][..],
        ),
        (
            "\n0,1,",
            "\n0,0,",
            &["line 3", "radial_position_mm", "previous row"],
        ),
    ] {
        refused(&made(PROFILE, &map().replacen(from, to, 1)), parts);
    }
    refused(&made(PROFILE, HEADER), &["map.csv", "empty"]);
    let shear = made(&format!("{PROFILE}component = \"shear\"\n"), &map());
    refused(&shear, &["plot.0.component", "shear", "normal, radial"]);
}

#[test]
fn maps_of_other_scenes_are_refused() {
    let class_map = PROFILE.replace("profile", "class-map");
    refused(&made(&class_map, &map()), &["class-map", "glide", "press"]);
    let glide = config("[]", PROFILE).replace("kind = \"press\"", "kind = \"glide\"");
    refused(
        &cells().study_with(&glide, &map()),
        &["profile", "press", "glide"],
    );
}

#[test]
fn profiles_of_any_size_are_drawn() {
    for scale in [0.0, 5e-324, 1e-9, 1e9, 1e100] {
        let text = format!("{HEADER}0,0,{scale},0,,\n0,{},0,0,{scale},\n", 1e-9);
        let svg = drawn(&made(PROFILE, &text));
        assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{scale}");
    }
}

fn spreads() -> Cells {
    let mut cells = Cells::new("scene.object,scene.motion.indentation_mm");
    for (at, (object, ..)) in OBJECTS.iter().enumerate() {
        for depth in [0.5, 1.0] {
            let std = 0.01 * (at + 1) as f64 / depth;
            let numbers = Numbers {
                truth: Some(0.05),
                trials: 100,
                std: Some(std),
                bound: (depth > 0.6).then_some(0.9 * std),
                ..Numbers::default()
            };
            cells.push_of(
                &format!("{object},{depth}"),
                "relative_curvature,1/mm",
                numbers,
                "",
            );
        }
    }
    cells
}

fn spread(plots: &str) -> Study {
    spreads().study(&config("[]", plots))
}

#[test]
fn bad_points_are_refused() {
    let labels = "[[plot]]\nx = \"scene.object\"\ny = \"std\"\nwhere = { \"scene.motion.indentation\" = 1 }\n";
    let log = format!("{LINES}scale = \"log-y\"\n");
    for (plot, points, parts) in [
        (
            LINES,
            "x = [1, 2]\ny = [1]",
            &["plot.0.points.0.y", "1 values", "`x` has 2"][..],
        ),
        (
            LINES,
            "x = [1]\ny = [1]\nseries = \"cube\"",
            &["cube", "known", "plane"],
        ),
        (
            LINES,
            "x = [1]\ny = [1]\npanel = \"plane\"",
            &["panel \"plane\"", "panels:"],
        ),
        (&log, "x = [1]\ny = [0]", &["point at y = 0", "log axis"]),
        (
            labels,
            "x = [1]\ny = [1]",
            &["numbers along x", "scene.object"],
        ),
    ] {
        refused(&spread(&format!("{plot}{POINTS}{points}\n")), parts);
    }
}
