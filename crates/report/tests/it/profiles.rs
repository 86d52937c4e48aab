//! Profiles of presses, reference points and the bound: their lines and texts, and rejected input.

use crate::fixture::{angular_velocity, count, drawn, refused, shows};
use crate::presses::{Cells, Numbers, OBJECTS, config};
use palpate_report::Study;

const PROFILE: &str = "[[plot]]\nname = \"p\"\nkind = \"profile\"\n";
const LINES: &str = "[[plot]]\nname = \"p\"\nx = \"scene.motion.indentation\"\ny = \"std\"\n\
    series = \"scene.object\"\n";
const HEADER: &str = "cell,radial_position_mm,normal_displacement_mm,radial_displacement_mm,\
    estimated_normal_displacement_mm,estimated_radial_displacement_mm\n";
const POINTS: &str = "[[plot.points]]\nlabel = \"published\"\n";

/// Colours of the first three objects, as in every plot of the study.
const BLUE: &str = "#0072B2";
const VERMILION: &str = "#D55E00";
const GREEN: &str = "#009E73";
/// Colour of marks that belong to no series, and its mixture with white.
const NEUTRAL: &str = "#3C3C3C";
const PALE_NEUTRAL: &str = "#9D9D9D";

/// Cells 0 … 5: each object with two estimators. The second estimator has no radial component.
fn cells() -> Cells {
    let mut cells = Cells::new("scene.object,scene.estimator");
    for (object, ..) in OBJECTS {
        for estimator in ["half-space", "gaussian"] {
            let numbers = Numbers {
                trials: 1,
                ..Numbers::default()
            };
            cells.push(&format!("{object},{estimator}"), "r_squared", numbers, "");
        }
    }
    cells
}

/// Three places per cell: truths differ between objects, estimates between all cells.
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
    cells().study(&config("[]", plots), Some(map))
}

/// Lines of a colour without those of the legend, which are as wide as its samples.
fn lines(svg: &str, colour: &str) -> usize {
    let of = svg
        .lines()
        .filter(|line| line.contains("<polyline") && line.contains(colour));
    of.filter(|line| line.contains("stroke-width=\"8\"") || line.contains("stroke-width=\"7\""))
        .count()
}

fn says(svg: &str, text: &str) -> bool {
    svg.contains(&format!("\n{text}\n"))
}

#[test]
fn a_line_per_cell_in_the_colour_of_its_object() {
    let only = "where = { \"scene.estimator\" = \"half-space\" }\n";
    let svg = drawn(&made(&(PROFILE.to_owned() + only), &map()));
    let texts = [
        "A question?",
        "For half-space: true displacements, and the estimates of one trial each.",
        "radial position (mm)",
        "displacement inward (mm)",
        "object",
        "dish of 80 mm",
        "plane",
        "ball of 80 mm",
        "truth",
        "estimate",
    ];
    shows(&svg, &texts);
    // The sample in the legend, and the dashes of the estimate.
    for colour in [BLUE, VERMILION, GREEN] {
        assert!(lines(&svg, colour) > 3, "{colour}");
    }
    assert!(
        !svg.contains("<circle"),
        "lines of a profile carry no markers"
    );
}

#[test]
fn a_truth_that_cells_share_is_drawn_once_and_is_nobodys() {
    let svg = drawn(&made(
        &(PROFILE.to_owned() + "panels = \"scene.object\"\n"),
        &map(),
    ));
    assert_eq!(lines(&svg, PALE_NEUTRAL), 3, "one in each panel");
    let titles = [
        "dish of 80 mm",
        "plane",
        "ball of 80 mm",
        "estimator",
        "half-space",
        "gaussian",
    ];
    shows(&svg, &titles);
    // Colours belong to the estimators here.
    assert!(lines(&svg, BLUE) > 3 && lines(&svg, VERMILION) > 3 && lines(&svg, GREEN) == 0);
}

#[test]
fn labels_are_made_of_what_differs() {
    let some = "where = { \"scene.object\" = [\"plane\", \"ball of 80 mm\"] }\n";
    let svg = drawn(&made(&(PROFILE.to_owned() + some), &map()));
    shows(
        &svg,
        &["plane, half-space", "plane, gaussian", "ball of 80 mm,"],
    );
}

#[test]
fn the_other_component_and_estimates_that_lack_it() {
    let radial = PROFILE.to_owned() + "component = \"radial\"\n";
    let of =
        |estimator: &str| format!("{radial}where = {{ \"scene.estimator\" = \"{estimator}\" }}\n");
    let svg = drawn(&made(&of("half-space"), &map()));
    assert!(says(&svg, "displacement along the skin, outward (mm)") && says(&svg, "estimate"));
    let svg = drawn(&made(&of("gaussian"), &map()));
    assert!(
        !svg.contains("estimate"),
        "nothing is said of estimates that are not there"
    );
    assert_eq!(lines(&svg, BLUE), 2, "the line and its sample");
}

#[test]
fn cells_without_a_profile_are_told() {
    let map: String = map()
        .lines()
        .filter(|line| !line.starts_with("5,"))
        .map(|line| format!("{line}\n"))
        .collect();
    let svg = drawn(&made(PROFILE, &map));
    assert!(svg.contains("No map: ball of 80 mm, gaussian."));
}

#[test]
fn bad_profiles_are_refused() {
    refused(&cells().study(&config("[]", PROFILE), None), &["map.csv"]);
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
        (
            "\n0,1,",
            "\n0,NaN,",
            &["line 3", "radial_position_mm", "NaN"],
        ),
        (
            "\n0,0,1,",
            "\n0,0,inf,",
            &["line 2", "normal_displacement_mm", "inf"],
        ),
        ("\n0,0,", "\nzero,0,", &["line 2", "\"cell\"", "zero"]),
    ] {
        refused(&made(PROFILE, &map().replacen(from, to, 1)), parts);
    }
    refused(&made(PROFILE, HEADER), &["map.csv", "empty"]);
    for (rest, parts) in [
        (
            "component = \"shear\"",
            &["plot.0.component", "shear", "normal, radial"][..],
        ),
        (
            "panels = \"scene.objet\"",
            &["panels", "scene.objet", "scene.object"],
        ),
        (
            "where = { \"scene.object\" = \"cube\" }",
            &["no cell", "scene.object = cube"],
        ),
    ] {
        refused(&made(&format!("{PROFILE}{rest}\n"), &map()), parts);
    }
    // There are only seven colours for these eight lines.
    let mut many = Cells::new("scene.motion.indentation_mm");
    let mut table = HEADER.to_owned();
    for cell in 0..8 {
        many.push(&cell.to_string(), "r_squared", Numbers::default(), "");
        table += &format!("{cell},0,1,0,,\n");
    }
    refused(
        &many.study(&config("[]", PROFILE), Some(&table)),
        &["8 lines", "at most 7"],
    );
}

#[test]
fn maps_of_other_scenes_are_refused() {
    let class_map = PROFILE.replace("profile", "class-map");
    refused(&made(&class_map, &map()), &["class-map", "glide", "press"]);
    let glide = config("[]", PROFILE).replace("kind = \"press\"", "kind = \"glide\"");
    refused(
        &cells().study(&glide, Some(&map())),
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

/// Two indentations per object.
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
            cells.push(
                &format!("{object},{depth}"),
                "relative_curvature",
                numbers,
                "",
            );
        }
    }
    cells
}

fn spread(plots: &str) -> Study {
    spreads().study(&config("[]", plots), None)
}

#[test]
fn the_bound_is_drawn_and_told_where_there_is_one() {
    let svg = drawn(&spread(&(LINES.to_owned() + "compare = \"std_bound\"\n")));
    assert!(says(&svg, "standard deviation") && says(&svg, "Cramér–Rao bound"));
    assert!(svg.contains("Not drawn: 3 points are undefined in the table"));
    let svg = drawn(&spread(&LINES.replace("\"std\"", "\"std_bound\"")));
    assert!(says(
        &svg,
        "Cramér–Rao bound on the std of relative curvature (1/mm)"
    ));
    let rolls = angular_velocity("[[plot]]\nx = \"truth\"\ny = \"std_bound\"\n");
    assert!(!rolls.cells().statistics().any(|name| name == "std_bound"));
    refused(&rolls, &["y = \"std_bound\" is no column"]);
}

#[test]
fn points_are_open_markers_in_the_colour_of_their_series() {
    let plain = LINES.to_owned();
    let svg = drawn(&spread(&plain));
    let polygons = |svg: &str, colour: &str| count(svg, "polygon", colour);
    let (before, neutral) = (polygons(&svg, VERMILION), polygons(&svg, NEUTRAL));
    let points = format!("{plain}{POINTS}x = [0.6, 2.4]\ny = [0.02, 0.3]\nseries = \"plane\"\n");
    let svg = drawn(&spread(&points));
    assert!(says(&svg, "published"));
    assert_eq!(
        polygons(&svg, VERMILION),
        before + 3,
        "two and their sample"
    );
    // The ranges of the axes include the points.
    assert!(says(&svg, "2.0") && says(&svg, "0.30"));
    // Points with one label and several colours have one sample, in a neutral colour.
    let points = points
        + POINTS
        + "x = [0.7]\ny = [0.01]\n"
        + "[[plot.points]]\nlabel = \"other\"\nx = [1]\ny = [0.02]\n";
    let svg = drawn(&spread(&points));
    assert_eq!(svg.matches("\npublished\n").count(), 1);
    assert_eq!(
        polygons(&svg, NEUTRAL),
        neutral + 4,
        "one and its sample, of each label"
    );
}

#[test]
fn points_stand_in_their_panel() {
    let panels = LINES.replace("series", "panels");
    let drawn = |points: &str| {
        count(
            &drawn(&spread(&format!("{panels}{points}"))),
            "polygon",
            NEUTRAL,
        )
    };
    let all = format!("{POINTS}x = [0.6]\ny = [0.02]\n");
    assert_eq!(drawn(&all), 4);
    assert_eq!(drawn(&(all + "panel = \"plane\"\n")), 2);
}

#[test]
fn points_of_a_profile_take_the_colour_of_a_line() {
    let one = format!(
        "{PROFILE}panels = \"scene.object\"\nmarks = [{{ axis = \"x\", value = 1, label = \"edge\" }}]\n\
        {POINTS}x = [0, 1]\ny = [0.9, 0.4]\nseries = \"gaussian\"\npanel = \"plane\"\n"
    );
    let svg = drawn(&made(&one, &map()));
    assert_eq!(count(&svg, "polygon", VERMILION), 3);
    assert!(says(&svg, "edge"));
    let several = format!(
        "{PROFILE}where = {{ \"scene.object\" = [\"plane\", \"ball of 80 mm\"] }}\n\
        {POINTS}x = [1]\ny = [0.4]\nseries = \"plane, gaussian\"\n"
    );
    assert!(drawn(&made(&several, &map())).contains("\npublished\n"));
    refused(
        &made(
            &several.replace("series = \"plane, gaussian\"", "series = \"dish\""),
            &map(),
        ),
        &["published", "dish", "plane, half-space"],
    );
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
