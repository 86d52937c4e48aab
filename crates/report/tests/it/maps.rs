//! Class maps: what is drawn and told, what is refused.

use crate::glides::{cells, config, map, study};
use palpate_report::{Study, page, plot};
use std::fs;
use tempfile::TempDir;

const PLOT: &str = "[[plot]]\nname = \"map\"\nkind = \"class-map\"\n";
const AXES: &str = "scene.noise.position.fraction_of_ifd,scene.estimator";
const PLACES: [&str; 2] = ["0.05,two-pass", "0.05,penalised"];
/// A saddle ridge in one corner, as it is, and as it might be found.
const TRUTH: &str = "rrrrrrrss";
const FOUND: &str = "rrr rrpss";

fn drawn(config_rest: &str, map: &str) -> (TempDir, Study) {
    let (dir, study) = study(
        &(config(0.3, "") + config_rest),
        &cells(AXES, &PLACES),
        &[("map.csv", map)],
    );
    plot(&study).unwrap();
    (dir, study)
}

fn svg(dir: &TempDir) -> String {
    fs::read_to_string(dir.path().join("map.svg")).unwrap()
}

#[track_caller]
fn refused(plot_text: &str, map: Option<&str>, parts: &[&str]) {
    let tables: Vec<(&str, &str)> = map.map(|text| ("map.csv", text)).into_iter().collect();
    let (dir, study) = study(
        &(config(0.3, "") + plot_text),
        &cells(AXES, &PLACES),
        &tables,
    );
    let error = plot(&study).unwrap_err().to_string();
    for part in parts {
        assert!(error.contains(part), "{part:?} is not in: {error}");
    }
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 3 + tables.len());
}

#[test]
fn the_true_map_stands_first_and_each_panel_tells_its_cell_and_share() {
    let (dir, study) = drawn(PLOT, &map(&[(FOUND, TRUTH), (TRUTH, TRUTH)]));
    let text = svg(&dir);
    let place = |part: &str| {
        text.find(&format!("\n{part}\n"))
            .unwrap_or_else(|| panic!("{part}"))
    };
    // 7 of 9, and 9 of 9.
    assert!(place("truth") < place("77.8 % correct"));
    assert!(place("77.8 % correct") < place("two-pass"));
    assert!(place("two-pass") < place("100 % correct"));
    for part in [
        "penalised",
        "saddle, a = 0.3 · position noise 5 % of the IFD · 3 × 3 points · one trial per panel",
        "x (mm)",
        "y (mm)",
        "true boundary",
        "not classified",
        "saddle ridge",
    ] {
        place(part);
    }
    // Only the classes that occur, each in its colour: the truth, both cells and the key.
    for absent in ["minimal", "flat", "pit", "valley"] {
        assert!(!text.contains(&format!("\n{absent}\n")), "{absent}");
    }
    for (colour, least) in [("#D24F1F", 4), ("#F7A64A", 4), ("#7A1F12", 2)] {
        assert!(text.matches(colour).count() >= least, "{colour}");
    }
    let html = page(std::slice::from_ref(&study)).unwrap();
    assert!(html.contains("77.8 % correct") && html.contains("class-map"));
    assert!(
        fs::read(dir.path().join("map.png"))
            .unwrap()
            .starts_with(b"\x89PNG")
    );
}

#[test]
fn squares_fill_the_panel_as_the_table_says() {
    // The one square of another class of a 2 × 2 grid is the upper right: the largest x and y.
    let (dir, _) = drawn(PLOT, &map(&[("rrrs", "rrrr"), ("rrrr", "rrrr")]));
    let text = svg(&dir);
    let corners = |colour: &str| {
        let polygons = text
            .lines()
            .filter(|line| line.contains("<polygon") && line.contains(colour));
        let boxes = polygons.map(|line| {
            let points = line
                .split("points=\"")
                .nth(1)
                .unwrap()
                .split('"')
                .next()
                .unwrap();
            let numbers = points.split_whitespace().map(|point| {
                let (x, y) = point.split_once(',').unwrap();
                (
                    x.parse::<f64>().unwrap() / 3.0,
                    y.parse::<f64>().unwrap() / 3.0,
                )
            });
            let all: Vec<(f64, f64)> = numbers.collect();
            let pick = |get: fn(&(f64, f64)) -> f64| {
                let low = all.iter().map(get).fold(f64::INFINITY, f64::min);
                (low, all.iter().map(get).fold(0.0, f64::max))
            };
            (pick(|p| p.0), pick(|p| p.1))
        });
        // The first is the sample in the key.
        boxes.skip(1).collect::<Vec<_>>()
    };
    let ridges = corners("#D24F1F");
    let saddle = corners("#F7A64A");
    // Truth and the second cell are one square each; the first cell is a column and a half.
    assert_eq!((ridges.len(), saddle.len()), (4, 1));
    let ((left, right), (top, bottom)) = saddle[0];
    let column = ridges[1];
    let under = ridges[2];
    assert!((column.1.1 - column.1.0 - 2.0 * (under.1.1 - under.1.0)).abs() < 4.0);
    assert!(left > column.0.0 && (left - column.0.1).abs() < 2.0 && right > left);
    assert!((top - column.1.0).abs() < 1.0 && bottom < under.1.1 && under.0 == (left, right));
}

#[test]
fn cells_are_chosen_and_those_without_a_map_are_told() {
    let filter =
        PLOT.to_owned() + "where = { \"scene.estimator\" = \"penalised\" }\nscale = \"linear\"\n";
    let (dir, _) = drawn(&filter, &map(&[(FOUND, TRUTH), (TRUTH, TRUTH)]));
    assert!(!svg(&dir).contains("77.8"));
    let (dir, _) = drawn(PLOT, &map(&[(FOUND, TRUTH)]));
    assert!(svg(&dir).contains("No map: position noise 5 % of the IFD, penalised."));
}

#[test]
fn bad_maps_are_refused() {
    let good = map(&[(FOUND, TRUTH), (TRUTH, TRUTH)]);
    refused(PLOT, None, &["map.csv"]);
    refused(
        PLOT,
        Some("cell,x,y\n"),
        &["map.csv", "\"class\"", "cell, x, y"],
    );
    refused(
        PLOT,
        Some(&good.replace("true_class", "real_class")),
        &["map.csv", "\"true_class\""],
    );
    refused(
        PLOT,
        Some(&good.replace("ridge", "rigde")),
        &["line 2", "\"class\"", "rigde", "eight classes"],
    );
    refused(
        PLOT,
        Some(&good.replace("0,-0.5,", "0,NaN,")),
        &["line 2", "x_mm", "NaN"],
    );
    refused(
        PLOT,
        Some(&good.replace("\n0,", "\nzero,")),
        &["line 2", "\"cell\"", "zero"],
    );
    let short = good.lines().take(9).collect::<Vec<_>>().join("\n");
    refused(PLOT, Some(&short), &["8 points of cell 0"]);
    refused(
        PLOT,
        Some(&good.replace("0,-0.5,", "0,0.5,")),
        &["x slowest", "cell 0"],
    );
    refused(
        PLOT,
        Some(good.lines().next().unwrap()),
        &["map.csv", "empty"],
    );
}

#[test]
fn bad_specifications_are_refused() {
    let good = map(&[(FOUND, TRUTH), (TRUTH, TRUTH)]);
    let with = |rest: &str| PLOT.to_owned() + rest;
    refused(
        &with("x = \"truth\"\n"),
        Some(&good),
        &["plot[0].x", "class-map", "where"],
    );
    refused(
        &with("scale = \"log-y\"\n"),
        Some(&good),
        &["plot[0].scale", "linear"],
    );
    refused(
        "[[plot]]\nkind = \"heat\"\n",
        Some(&good),
        &["plot[0].kind", "heat", "class-map, contacts"],
    );
    refused(
        &with("where = { \"scene.estimato\" = 1 }\n"),
        Some(&good),
        &["scene.estimato", "known: scene.estimator,"],
    );
    refused(
        &with("where = { \"scene.estimator\" = \"cubic\" }\n"),
        Some(&good),
        &["scene.estimator = cubic"],
    );
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
    let (_dir, study) = study(
        &(config(0.3, "") + PLOT),
        &cells(axes, &places),
        &[("map.csv", &map(&maps))],
    );
    let html = page(&[study]).unwrap();
    let text = &html[html.find("<svg").unwrap()..html.find("</svg>").unwrap()];
    assert_eq!(text.matches("\ntruth\n").count(), 2);
    assert_eq!(text.matches("% correct").count(), 14);
    let number = |line: &str, key: &str| -> f64 {
        let rest = line.split(&format!(" {key}=\"")).nth(1).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    };
    let (width, height) = (number(text, "width"), number(text, "height"));
    for line in text.lines().filter(|line| line.starts_with("<text")) {
        let (x, y) = (number(line, "x") / 3.0, number(line, "y") / 3.0);
        assert!(x > 0.0 && x < width && y > 0.0 && y < height, "{line}");
    }
}
