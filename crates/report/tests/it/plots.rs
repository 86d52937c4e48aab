//! Plots: what is drawn, what is said about the rest, what is refused.

use crate::fixture::{Cells, Numbers, angular_velocity, config};
use palpate_report::{Study, plot};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const BASIC: &str = "[[plot]]\nx = \"scene.noise.angular_velocity.fraction\"\ny = \"relative_mean_abs_error\"\n\
    quantity = \"normal_curvature_u\"\nseries = \"scene.object.radius\"\nscale = \"log-log\"\n";

/// The config's plots come after its tables.
fn with_plots(plots: &str) -> (TempDir, Study) {
    let (dir, _) = angular_velocity("");
    let path = dir.path().join("run.toml");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text + plots).unwrap();
    let study = Study::load(dir.path()).unwrap();
    (dir, study)
}

fn svg(dir: &Path, name: &str) -> String {
    fs::read_to_string(dir.join(format!("{name}.svg"))).unwrap()
}

#[track_caller]
fn refused(plots: &str, parts: &[&str]) {
    let (dir, study) = with_plots(plots);
    let error = plot(&study).unwrap_err().to_string();
    for part in parts {
        assert!(error.contains(part), "{part:?} is not in: {error}");
    }
    assert_eq!(
        fs::read_dir(dir.path()).unwrap().count(),
        3,
        "something was written"
    );
}

#[test]
fn svg_and_png_are_written_twice_the_same() {
    let (dir, study) = with_plots(BASIC);
    let files = plot(&study).unwrap();
    assert_eq!(
        files,
        ["plot-1.svg", "plot-1.png"].map(|name| dir.path().join(name))
    );
    let first: Vec<Vec<u8>> = files.iter().map(|file| fs::read(file).unwrap()).collect();
    assert!(first[1].starts_with(b"\x89PNG"));
    plot(&study).unwrap();
    let second: Vec<Vec<u8>> = files.iter().map(|file| fs::read(file).unwrap()).collect();
    assert!(first == second);
    assert_eq!(
        fs::read_dir(dir.path()).unwrap().count(),
        5,
        "a temporary file is left"
    );
}

#[test]
fn axes_are_words_with_units_in_real_text() {
    let (dir, study) = with_plots(BASIC);
    plot(&study).unwrap();
    let svg = svg(dir.path(), "plot-1");
    for text in [
        "A question?",
        "100 trials per point",
        "angular velocity noise (%)",
        "mean |relative error| of normal curvature along u (%)",
        "object radius (cm)",
    ] {
        assert!(svg.contains(&format!("\n{text}\n")), "{text}");
    }
    assert!(svg.contains("font-family=\"sans-serif\""));
    assert!(!svg.contains("id=\""), "ids would clash on a page");
    assert!(svg.starts_with("<svg width=\"960\""));
}

#[test]
fn colours_belong_to_values_not_to_places_in_a_plot() {
    let one = BASIC.to_owned() + "where = { \"scene.object.radius\" = 5 }\n";
    let (dir, study) = with_plots(&one);
    plot(&study).unwrap();
    let svg = svg(dir.path(), "plot-1");
    // Okabe and Ito's third colour, for the third radius of the study; the first does not occur.
    assert!(svg.contains("#009E73") && !svg.contains("#0072B2"));
    assert!(svg.contains("object radius 5 cm · 100 trials per point"));
}

#[test]
fn a_free_axis_is_named() {
    refused(
        &BASIC.replace("series = \"scene.object.radius\"\n", ""),
        &[
            "run.toml",
            "plot-1",
            "fraction = 0.001",
            "scene.object.radius_cm (4 values, 500 … 0.5)",
        ],
    );
}

#[test]
fn unknown_names_are_answered_with_the_nearest() {
    let change = |from: &str, to: &str| BASIC.replace(from, to);
    refused(
        &change("relative_mean_abs", "relative_mean_absolute"),
        &[
            "y = \"relative_mean_absolute_error\"",
            "known: relative_mean_abs_error,",
        ],
    );
    refused(
        &change("object.radius", "object.radios"),
        &["series", "known: scene.object.radius_cm,"],
    );
    refused(
        &change("normal_curvature_u", "normal_curvature"),
        &["quantity", "known: normal_curvature_u"],
    );
    refused(
        &change("scale =", "scales ="),
        &["plot[0].scales", "known: scale,"],
    );
    refused(
        &change("log-log", "loglog"),
        &["plot[0].scale", "loglog", "log-log"],
    );
    refused(
        &(BASIC.to_owned() + "where = { \"scene.object.size\" = 5 }\n"),
        &["where = \"scene.object.size\""],
    );
    refused(
        &(BASIC.to_owned() + "where = { \"scene.object.radius\" = 7 }\n"),
        &["no rows", "scene.object.radius = 7"],
    );
}

#[test]
fn malformed_plots_are_refused_and_nothing_is_written() {
    refused("[[plot]]\nx = \"truth\"\n", &["plot[0].y", "missing"]);
    refused(
        &(BASIC.to_owned() + "name = \"../a\"\n"),
        &["plot[0].name", "../a"],
    );
    refused(
        &(BASIC.to_owned() + "name = \"a\"\n" + BASIC + "name = \"a\"\n"),
        &["plot[1].name", "another plot"],
    );
    refused(
        &(BASIC.to_owned() + "compare = \"rms_error\"\n"),
        &["compare", "1/cm", "%"],
    );
    refused(
        &(BASIC.to_owned() + "marks = [{ axis = \"y\", value = 0 }]\n"),
        &["mark", "y = 0"],
    );
    refused(
        &(BASIC.to_owned() + "marks = [{ axis = \"z\", value = 1 }]\n"),
        &["marks", "axis"],
    );
    refused(&(BASIC.to_owned() + "where = 3\n"), &["where", "3"]);
    // A good plot before a bad one is not drawn either.
    refused(
        &(BASIC.to_owned() + "[[plot]]\nx = \"truth\"\ny = \"nothing\"\n"),
        &["plot-2", "nothing"],
    );
}

#[test]
fn marks_comparison_panels_and_statistics_along_x_are_drawn() {
    let plots = BASIC.replace("series", "panels")
        + "name = \"a\"\nmarks = [{ axis = \"y\", value = 0.15, label = \"fifteen\" }]\n"
        + "[[plot]]\nname = \"b\"\nx = \"truth\"\ny = \"rms_error\"\ncompare = \"mean_reported_std\"\n\
           series = \"scene.noise.angular_velocity.fraction\"\n";
    let (dir, study) = with_plots(&plots);
    plot(&study).unwrap();
    let a = svg(dir.path(), "a");
    assert!(
        ["object radius 500 cm", "object radius 0.5 cm"]
            .iter()
            .all(|title| a.contains(title))
    );
    assert_eq!(a.matches("fifteen").count(), 1);
    let b = svg(dir.path(), "b");
    assert!(b.contains("mean reported std") && b.contains("true normal curvature along u (1/cm)"));
}

#[test]
fn what_cannot_be_drawn_is_counted_and_explained() {
    let mut cells = Cells::new("scene.sensor.pitch_cm,scene.object.radius_cm");
    for (place, rms, failures) in [
        ("0.1,5", Some(0.0), 0),
        ("0.2,5", Some(1e-3), 3),
        ("0.3,5", None, 100),
        ("0.1,1", Some(0.5), 0),
    ] {
        cells.push(
            place,
            Numbers {
                rms,
                failures,
                ..Numbers::new(1.0, 0.5)
            },
        );
    }
    let plots = "\n[[plot]]\nx = \"scene.sensor.pitch\"\ny = \"relative_rms_error\"\nseries = \"scene.object.radius\"\nscale = \"log-y\"\n";
    let (dir, study) = cells.study(&(config("sphere", "") + plots));
    plot(&study).unwrap();
    let svg = svg(dir.path(), "plot-1");
    for text in [
        "Not drawn: 1 point is exactly 0, which a log axis cannot show (object radius 5).",
        "Not drawn: 1 point is undefined in the table (object radius 5).",
        "Left out of every average: 103 failed trials of 400 (unresolved 103).",
    ] {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn labels_make_categories_and_are_escaped() {
    let mut cells = Cells::new("scene.sensor");
    for label in ["a <b> & \"\"c\"\" with a rather long name", "pads 1 mm"] {
        cells.push(&format!("\"{label}\""), Numbers::new(1.0, 0.5));
    }
    let plots = "\n[[plot]]\nx = \"scene.sensor\"\ny = \"relative_rms_error\"\ntitle = \"x < y & \\\"z\\\"\"\n";
    let (dir, study) = cells.study(&(config("sphere", "") + plots));
    plot(&study).unwrap();
    let text = svg(dir.path(), "plot-1");
    assert!(text.contains("&lt;b&gt;") && !text.contains("<b>"));
    assert!(text.contains("aria-label=\"x &lt; y &amp; &quot;z&quot;\""));
    let (_dir, study) = cells.study(&(config("sphere", "") + plots + "scale = \"log-x\"\n"));
    assert!(
        plot(&study)
            .unwrap_err()
            .to_string()
            .contains("cannot be logarithmic")
    );
}

#[test]
fn extreme_and_lone_values_are_drawn() {
    for scale in ["linear", "log-log"] {
        for errors in [
            vec![1.0],
            vec![1e-300, 1e298],
            vec![5e-324, 5e-324],
            vec![0.0, 0.0],
            vec![1e307, -1e307],
        ] {
            let mut cells = Cells::new("scene.object.radius_cm");
            for (at, error) in errors.iter().enumerate() {
                cells.push(
                    &format!("{}", at + 1),
                    Numbers {
                        rms: Some(*error),
                        ..Numbers::new(1.0, 0.5)
                    },
                );
            }
            let plots = format!(
                "\n[[plot]]\nx = \"scene.object.radius\"\ny = \"relative_rms_error\"\nscale = \"{scale}\"\n"
            );
            let (_dir, study) = cells.study(&(config("sphere", "") + &plots));
            assert_eq!(plot(&study).unwrap().len(), 2, "{scale} {errors:?}");
        }
    }
}

#[test]
fn a_long_legend_makes_a_taller_picture() {
    let mut cells = Cells::new("scene.object.radius_cm,scene.sensor.pitch_cm");
    for radius in 1..=40 {
        cells.push(&format!("{radius},1"), Numbers::new(1.0, f64::from(radius)));
    }
    let plots = "\n[[plot]]\nx = \"scene.sensor.pitch\"\ny = \"relative_rms_error\"\nseries = \"scene.object.radius\"\n";
    let (dir, study) = cells.study(&(config("sphere", "") + plots));
    plot(&study).unwrap();
    let text = svg(dir.path(), "plot-1");
    let number = |after: &str| -> f64 {
        text.split(after)
            .nth(1)
            .unwrap()
            .split('"')
            .next()
            .unwrap()
            .parse()
            .unwrap()
    };
    let height = number(" height=\"");
    let lowest = text
        .split(" y=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap().parse::<f64>().unwrap() / 3.0)
        .fold(0.0, f64::max);
    assert!(height > 900.0 && lowest < height - 9.0, "{height} {lowest}");
}

/// Places along x, in pixels, of the lines of text that are `word`.
fn across(svg: &str, word: &str) -> Vec<f64> {
    let number = |line: &str| {
        let x = line.split("x=\"").nth(1).unwrap();
        x.split('"').next().unwrap().parse::<f64>().unwrap() / 3.0
    };
    let lines: Vec<&str> = svg.lines().collect();
    let here = lines.windows(2).filter(|pair| pair[1] == word);
    here.map(|pair| number(pair[0])).collect()
}

#[test]
fn names_along_x_stand_beside_each_other() {
    for panels in ["", "panels = \"scene.object\"\n"] {
        let mut cells = Cells::new("scene.sensor,scene.object");
        for object in ["plane", "ball"] {
            for sensor in 0..8_u8 {
                let numbers = Numbers::new(1.0, 0.1 / f64::from(sensor + 1));
                cells.push(
                    &format!("rendered misaligned {sensor} px,{object}"),
                    numbers,
                );
            }
        }
        let series = if panels.is_empty() {
            "series = \"scene.object\"\n"
        } else {
            panels
        };
        let plots = format!(
            "\n[[plot]]\nx = \"scene.sensor\"\ny = \"relative_rms_error\"\nscale = \"log-y\"\n{series}"
        );
        let (dir, study) = cells.study(&(config("sphere", "") + &plots));
        plot(&study).unwrap();
        let places = across(&svg(dir.path(), "plot-1"), "misaligned");
        assert_eq!(places.len(), if panels.is_empty() { 8 } else { 16 });
        // The word is at least 80 pixels wide in any sans-serif of 18.
        assert!(
            places[..8].windows(2).all(|pair| pair[1] - pair[0] > 85.0),
            "{places:?}"
        );
    }
}

#[test]
fn many_and_long_names_make_no_endless_picture() {
    let mut cells = Cells::new("scene.sensor");
    for sensor in 0..40 {
        cells.push(
            &format!("{}{sensor}", "long".repeat(50)),
            Numbers::new(1.0, 0.1),
        );
    }
    let plots = "\n[[plot]]\nx = \"scene.sensor\"\ny = \"relative_rms_error\"\n";
    let (dir, study) = cells.study(&(config("sphere", "") + plots));
    plot(&study).unwrap();
    let text = svg(dir.path(), "plot-1");
    let width = text.split('"').nth(1).unwrap();
    assert!(width.parse::<f64>().unwrap() < 1700.0, "{width}");
}

#[test]
fn a_study_without_plots_writes_none() {
    let (_dir, study) = angular_velocity("");
    assert!(plot(&study).unwrap().is_empty());
}

#[test]
fn an_unwritable_folder_is_an_error() {
    let (dir, study) = with_plots(BASIC);
    drop(dir);
    assert!(plot(&study).unwrap_err().to_string().contains("plot-1.svg"));
}
