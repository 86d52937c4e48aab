//! Tests plots of kind `lines`: their content, notes about missing data, and input that is rejected.

use crate::fixture::{Cells, Numbers, angular_velocity, attribute, config, drawn, refused, shows};
use palpate_report::figures;

const BASIC: &str = "[[plot]]\nx = \"scene.noise.angular_velocity.fraction\"\ny = \"relative_mean_abs_error\"\n\
    quantity = \"normal_curvature_u\"\nseries = \"scene.object.radius\"\nscale = \"log-log\"\n";

#[test]
fn a_study_without_plots_gets_the_default_plot() {
    // The plot below is equal to the default plot, which draws the first swept field, the radius, along x.
    let asked = "[[plot]]\nx = \"scene.object.radius\"\ny = \"relative_rms_error\"\n\
        series = \"scene.noise.angular_velocity.fraction\"\nscale = \"log-log\"\n";
    assert_eq!(
        drawn(&angular_velocity("")),
        drawn(&angular_velocity(asked))
    );
    let table = |axes: &str, places: &[(&str, f64)]| {
        let mut cells = Cells::new(axes);
        for (place, error) in places {
            cells.push(place, Numbers::new(0.2, *error));
        }
        cells.study(&config("sphere", ""))
    };
    // Two fields that vary together are drawn as one field. Fields that do not vary are not drawn.
    let together = table(
        "scene.object.radius_cm,scene.probe.radius_cm,scene.object.s,scene.motion.duration_s",
        &[
            ("1,2,5,1", 0.1),
            ("1,2,5,2", 0.2),
            ("3,4,5,1", 0.3),
            ("3,4,5,2", 0.4),
        ],
    );
    let svg = drawn(&together);
    shows(
        &svg,
        &[
            "object radius (cm)",
            "duration (s)",
            "100 trials per point.",
        ],
    );
    assert!(!svg.contains("probe radius"));
    // A third varied field is drawn as several panels. A fourth varied field is drawn only at its first value.
    let places: Vec<(String, f64)> = (0..16)
        .map(|cell| {
            let [a, b, c, d] = [8, 4, 2, 1].map(|bit| 1 + (cell & bit) / bit);
            (format!("{a},{b},{c},{d}"), 0.1 * f64::from(cell + 1))
        })
        .collect();
    let places: Vec<(&str, f64)> = places
        .iter()
        .map(|(place, error)| (&**place, *error))
        .collect();
    let four = table(
        "scene.object.a,scene.object.b,scene.object.c,scene.object.radius_cm",
        &places,
    );
    shows(
        &drawn(&four),
        &[
            "object a",
            "object b",
            "For object radius 1 cm: 100 trials per point.",
        ],
    );
    // If the table contains no rms errors, the default plot shows the mean.
    let mut cells = Cells::new("scene.object.radius_cm");
    for radius in ["1", "2"] {
        cells.push(
            radius,
            Numbers {
                rms: None,
                ..Numbers::new(0.2, 0.1)
            },
        );
    }
    shows(
        &drawn(&cells.study(&config("sphere", ""))),
        &["mean estimate of normal curvature along u (1/cm)"],
    );
    // A study with only one cell has no default plot.
    let one = table("scene.object.radius_cm", &[("1", 0.1)]);
    assert!(figures(&one).unwrap().is_empty());
    // If the swept values are labels, they appear unchanged along x.
    let named = table("scene.object", &[("egg", 0.1), ("ball", 0.9)]);
    shows(&drawn(&named), &["egg", "ball"]);
}

#[test]
fn a_picture_in_pixels_has_its_size_and_its_letters() {
    let figure = figures(&angular_velocity(BASIC)).unwrap().remove(0);
    let png = figure.png().unwrap();
    assert!(png.starts_with(b"\x89PNG"));
    assert_eq!(png, figure.png().unwrap());
    // In a PNG file, width and height follow the name of the first chunk.
    let number = |at: usize| f64::from(u32::from_be_bytes(png[at..at + 4].try_into().unwrap()));
    let size = ["width", "height"].map(|name| attribute(&figure.svg, name));
    assert_eq!([number(16), number(20)], size);
    let other = figures(&angular_velocity(&format!("{BASIC}title = \"B\"\n")));
    assert!(png != other.unwrap()[0].png().unwrap(), "titles are drawn");
}

#[test]
fn unknown_names_are_refused_with_similar_ones() {
    let with = |rest: &str| format!("{BASIC}{rest}\n");
    let without = |line: &str| BASIC.replace(line, "");
    let change = |from: &str, to: &str| BASIC.replace(from, to);
    for (plots, parts) in [
        (
            without("series = \"scene.object.radius\"\n"),
            &[
                "run.toml",
                "plot-1",
                "fraction = 0.001",
                "radius_cm (4 values, 500 … 0.5)",
            ][..],
        ),
        (
            change("relative_mean_abs", "relative_mean_absolute"),
            &[
                "y = \"relative_mean_absolute_error\"",
                "possible: relative_mean_abs_error,",
            ],
        ),
        (
            change("object.radius", "object.radios"),
            &["series", "possible: scene.object.radius_cm,"],
        ),
        (
            change("curvature_u", "curvature"),
            &["quantity", "possible: normal_curvature_u"],
        ),
        (
            with("where = { \"scene.object.size\" = 5 }"),
            &["where = \"scene.object.size\""],
        ),
        (
            with("where = { \"scene.object.radius\" = 7 }"),
            &["no rows", "scene.object.radius = 7"],
        ),
        (with("compare = \"rms_error\""), &["compare", "1/cm", "%"]),
        // If one plot is invalid, no plot is drawn, not even a valid plot before it.
        (
            with("[[plot]]\nx = \"truth\"\ny = \"nothing\""),
            &["plot-2", "nothing"],
        ),
        // Errors in plots are also found when the config is parsed.
        (with("where = 3"), &["run.toml:", "plot.0.where", "table"]),
        (
            with("name = \"../a\""),
            &["run.toml:", "plot.0.name", "../a"],
        ),
    ] {
        refused(&angular_velocity(&plots), parts);
    }
}

#[test]
fn labels_make_categories_and_are_escaped() {
    let mut cells = Cells::new("scene.sensor");
    for label in ["a <b> & \"\"c\"\" with a rather long name", "pads 1 mm"] {
        cells.push(&format!("\"{label}\""), Numbers::new(1.0, 0.5));
    }
    let plots = "\n[[plot]]\nx = \"scene.sensor\"\ny = \"relative_rms_error\"\ntitle = \"x < y & \\\"z\\\"\"\n";
    let text = drawn(&cells.study(&config("sphere", plots)));
    assert!(text.contains("&lt;b&gt;") && !text.contains("<b>"));
    assert!(text.contains("aria-label=\"x &lt; y &amp; &quot;z&quot;\""));
    let log = format!("{plots}scale = \"log-x\"\n");
    refused(
        &cells.study(&config("sphere", &log)),
        &["cannot be logarithmic", "a <b>"],
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
                let rms = Some(*error);
                let numbers = Numbers::new(1.0, 0.5);
                cells.push(&(at + 1).to_string(), Numbers { rms, ..numbers });
            }
            let plots = format!(
                "\n[[plot]]\nx = \"scene.object.radius\"\ny = \"relative_rms_error\"\nscale = \"{scale}\"\n"
            );
            let svg = drawn(&cells.study(&config("sphere", &plots)));
            assert!(
                !svg.contains("NaN") && !svg.contains("inf\""),
                "{scale} {errors:?}"
            );
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
    let text = drawn(&cells.study(&config("sphere", plots)));
    let height = attribute(&text, "height");
    let texts = text.lines().filter(|line| line.starts_with("<text"));
    let lowest = texts
        .map(|line| attribute(line, "y") / 3.0)
        .fold(0.0, f64::max);
    assert!(height > 900.0 && lowest < height - 9.0, "{height} {lowest}");
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
    let width = attribute(&drawn(&cells.study(&config("sphere", plots))), "width");
    assert!(width < 1700.0, "{width}");
}

#[test]
fn points_of_survivors_are_circled() {
    let circles = |failures: [u64; 3]| {
        let mut cells = Cells::new("scene.sensor.pitch_cm");
        for (pitch, failures) in [0.1, 0.2, 0.4].into_iter().zip(failures) {
            let numbers = Numbers::new(0.2, pitch);
            cells.push(
                &pitch.to_string(),
                Numbers {
                    failures,
                    ..numbers
                },
            );
        }
        let plot = "\n[[plot]]\nx = \"scene.sensor.pitch\"\ny = \"relative_rms_error\"\ncompare = \"relative_mean_abs_error\"\n";
        let svg = drawn(&cells.study(&config("sphere", plot)));
        (svg.matches("<circle").count(), svg)
    };
    // A point has a circle if 6 of 100 trials failed, but not if 5 failed.
    let (plain, svg) = circles([0, 0, 5]);
    assert!(!svg.contains("Circled"), "{svg}");
    let (one, svg) = circles([0, 0, 6]);
    shows(
        &svg,
        &["Circled: points at which more than 5 % of the trials failed."],
    );
    assert_eq!(one, plain + 2);
    let (two, svg) = circles([0, 49, 6]);
    shows(
        &svg,
        &["Circled: points at which more than 5 % of the trials failed."],
    );
    assert_eq!(two, plain + 4);
}
