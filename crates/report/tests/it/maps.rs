//! Tests figures of kind `class-map` and `class-surface`: their shapes and texts, and input that is rejected.

use crate::fixture::{attribute, count, drawn, refused, shows};
use crate::glides::{cells, config, map, study};
use palpate_report::Study;

const PLOT: &str = "[[plot]]\nname = \"map\"\nkind = \"class-map\"\n";
const AXES: &str = "scene.noise.position.fraction_of_ifd,scene.estimator";
const PLACES: [&str; 2] = ["0.05,two-pass", "0.05,penalised"];
/// True classes on a grid of 3 × 3 points, with a saddle ridge in one corner.
const TRUTH: &str = "rrrrrrrss";
/// Estimated classes on the grid of `TRUTH`. The space is a point without an estimated class.
const FOUND: &str = "rrr rrpss";

fn made(plots: &str, map: &str) -> Study {
    let config = config(0.3, "") + plots;
    study(&config, &cells(AXES, &PLACES), &[("map.csv", map)])
}

#[test]
fn cells_are_selected_and_those_without_a_map_are_listed() {
    let filter =
        PLOT.to_owned() + "where = { \"scene.estimator\" = \"penalised\" }\nscale = \"linear\"\n";
    let both = map(&[(FOUND, TRUTH), (TRUTH, TRUTH)]);
    assert!(!drawn(&made(&filter, &both)).contains("77.8"));
    let text = drawn(&made(PLOT, &map(&[(FOUND, TRUTH)])));
    shows(
        &text,
        &["No map: position noise 5 % of the IFD, penalised."],
    );
}

#[test]
fn bad_maps_are_refused() {
    let good = map(&[(FOUND, TRUTH), (TRUTH, TRUTH)]);
    let change = |from: &str, to: &str| good.replace(from, to);
    let lines = |count: usize| good.lines().take(count).collect::<Vec<_>>().join("\n");
    let none = study(&(config(0.3, "") + PLOT), &cells(AXES, &PLACES), &[]);
    refused(&none, &["map.csv"]);
    for (map, parts) in [
        (
            "cell,x,y\n".to_owned(),
            &["map.csv", "\"class\"", "cell, x, y"][..],
        ),
        (
            change("ridge", "rigde"),
            &["line 2", "\"class\"", "rigde", "eight classes"],
        ),
        (lines(9), &["8 points of cell 0"]),
        (change("0,-0.5,", "0,0.5,"), &["x slowest", "cell 0"]),
        (lines(1), &["map.csv", "empty"]),
    ] {
        refused(&made(PLOT, &map), parts);
    }
    for (rest, parts) in [
        ("x = \"truth\"", &["plot.0.x", "class-map", "where"][..]),
        (
            "where = { \"scene.estimato\" = 1 }",
            &["scene.estimato", "possible: scene.estimator,"],
        ),
        (
            "where = { \"scene.estimator\" = \"cubic\" }",
            &["scene.estimator = cubic"],
        ),
    ] {
        refused(&made(&format!("{PLOT}{rest}\n"), &good), parts);
    }
}

#[test]
fn many_cells_are_laid_out_without_leaving_the_picture() {
    let places: Vec<String> = ["sphere", "saddle"]
        .iter()
        .flat_map(|object| (0..7).map(move |noise| format!("{object},{noise}")))
        .collect();
    let places: Vec<&str> = places.iter().map(String::as_str).collect();
    let maps: Vec<(&str, &str)> = (0..14)
        .map(|cell| {
            if cell < 7 {
                ("pppp", "pppp")
            } else {
                ("rrrs", "ssss")
            }
        })
        .collect();
    let axes = "scene.object,scene.noise.normal.std_deg";
    let config = config(0.3, "") + PLOT;
    let maps = map(&maps);
    let text = drawn(&study(
        &config,
        &cells(axes, &places),
        &[("map.csv", &maps)],
    ));
    assert_eq!(text.matches("\ntruth\n").count(), 2);
    assert_eq!(text.matches("% correct").count(), 14);
    let (width, height) = (attribute(&text, "width"), attribute(&text, "height"));
    for line in text.lines().filter(|line| line.starts_with("<text")) {
        let (x, y) = (attribute(line, "x") / 3.0, attribute(line, "y") / 3.0);
        assert!(x > 0.0 && x < width && y > 0.0 && y < height, "{line}");
    }
}

#[test]
fn classes_are_drawn_on_the_fitted_surface() {
    let plot = PLOT.replace("class-map", "class-surface");
    let both = map(&[(FOUND, TRUTH), (TRUTH, TRUTH)]);
    let text = drawn(&made(&plot, &both));
    shows(
        &text,
        &[
            "two-pass · 77.8 % correct",
            "penalised · 100 % correct",
            "saddle ridge",
            "x (mm)",
            "z (mm)",
        ],
    );
    // Two squares have the colour of the class `peak`: one on the first surface, and one in the key.
    assert_eq!(count(&text, "polygon", "#7A1F12"), 2);
    let bare = both.replace("z_mm", "w_mm");
    refused(&made(&plot, &bare), &["map.csv", "\"z\""]);
    refused(
        &made(&plot, &both.replace(",0,ridge", ",inf,ridge")),
        &["z_mm", "inf"],
    );
    // A surface may have any size and slope, and may even consist of a single point.
    for height in ["1e-300", "-5e99", "0.25"] {
        let text = drawn(&made(
            &plot,
            &both.replace(",0,saddle", &format!(",{height},saddle")),
        ));
        assert!(!text.contains("NaN") && !text.contains("inf"), "{height}");
    }
    assert!(drawn(&made(&plot, &map(&[("r", "r")]))).contains("100 % correct"));
}
