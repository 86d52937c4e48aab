//! Tests studies that cannot be run: the error states the field, the position and the reason.

use palpate::config::ConfigError;
use palpate::{RunOptions, Runner, Simulation, check_outputs, parse};

use super::desk::{Desk, SCENE, STUDY, assert_untouched, edited};
use super::glide::GLIDE;

/// Each row is an edit of a config for a roll: `text => replacement | line:column path | words of the expected error`.
/// `\n` ends a line.
const ROLLS: &str = r#"
1.0 }\n => 1.0 }\nsensor = { kind = "pads", pitch = 40.0 }\n | 10:35 scene.sensor.pitch | at most the probe's radius
"sphere", radius = 50.0 => "height-field", formula = "sin(k*x)" | 8:50 scene.object.formula | unknown name `k`
"sphere", radius = 50.0 => "height-field", formula = "sin(x)+*2" | 8:53 scene.object.formula | found `*`
"sphere", radius = 50.0 => "height-field", formula = "sqrt(x - 1)" | 8:45 scene.object.formula | x = 0, y = 0
"sphere", radius = 50.0 => "height-field", formula = "" | 8:45 scene.object.formula | is empty
"sphere", radius = 50.0 => "dish", radius = 10 | 8:10 scene.object | conform
1.0 }\n => 1.0 }\nobject_contact = [60, 0]\n | 10:18 scene.object_contact | x = 60, y = 0
1.0 }\n => 1.0, directions_deg = [0] }\n | 9:69 scene.motion.directions_deg | 1 probe(s)
1.0 }\n => 1.0, directions_deg = [30, 210] }\n | 9:69 scene.motion.directions_deg | do not span
"sphere", radius = 50.0 => "height-field", formula = "8*exp(-((x-6)^2+y^2)/2)" | 9:10 scene.motion | overlaps the object by 3.83
1.0 }\n => 1.0 }\nnoise = { encoder = { step_deg = 60 }, rotation = { std_deg = 1 } }\n | 10:21 scene.noise.encoder | more than 0.5
1.0 }\n => 1.0 }\nnoise = { encoder = { step_deg = 1 }, rotation = { std_deg = 60 } }\n | 10:50 scene.noise.rotation | more than 0.5
"sphere", radius = 50.0 } => "saddle", a = 0.001 }\nmodel = { kind = "closed-form" } | 9:18 scene.model.kind | saddle
length_unit => outputs = ["map"]\nlength_unit | 2:11 outputs | no map
length_unit => claims = [2, 999]\nlength_unit | 2:14 claims.1 | no claim 999
"#;

const GLIDES: &str = r#"
0.00005, mean => 0.000001, mean | 13:64 scene.evaluate.gaussian_threshold | below the square of the mean threshold
"saddle", a = 0.01 => "dish", radius = 3 | 9:37 scene.probe.radius | more than one place
"saddle", a = 0.01 => "sphere", radius = 10 | 11:10 scene.motion | beside the object
[-15.0, 0.0, 15.0] => [0.0] | 11:10 scene.motion | on a line
distance = 10.0 => distance = 1e300 | 17:14 scene.noise.position.fraction_of_ifd | must be from 0 to 1e150
evaluate => estimator = { kind = "penalised", criterion = "reml", gamma = 2.0 }\nevaluate | 13:63 scene.estimator.gamma | "robust-gcv"
"#;

/// Plots that cannot be drawn for a study that sweeps two radii. Each row: `sections | path | words of the expected
/// error`.
const PLOTS: &str = r#"
[[plot]]\nx = "scene.object.radius"\ny = "mean"\nquantity = "radius" | plot.0.quantity | is not a column
[[plot]]\nx = "scene.object.radius"\ny = "mean"\nquantity = "principal_curvature_max" | plot.0.quantity | and principal_curvature_max if the config sets `scene.principal_curvatures = true`
[[plot]]\nx = "scene.object.radius"\ny = "trials" | plot.0 | several rows share scene.object.radius = 5
[[plot]]\nx = "scene.object.radius"\ny = "mean"\nquantity = "arc_length"\nscale = "log-y"\nmarks = [{ axis = "y", value = -1.0, label = "a" }] | plot.0 | the mark at y = -1
[[plot]]\nx = "scene.object.radius"\ny = "mean"\nquantity = "arc_length"\ncompare = "trials" | plot.0.compare | must have the same unit
[[sweep]]\npath = "seed"\nvalues = [1, 2]\n[[plot]]\nx = "scene.object.radius"\ny = "mean"\nquantity = "arc_length" | plot.0 | seed (1 or 2)
"#;

fn error(config: &str) -> ConfigError {
    let checked = parse("c.toml", config).and_then(|study| {
        check_outputs(&study)?;
        let runner = Runner::new(&RunOptions::default()).unwrap();
        Simulation::new(&study, 0..study.cell_count(), &runner).map(drop)
    });
    checked.expect_err(config)
}

fn assert_refused(base: &str, table: &str) {
    for row in table.trim().lines() {
        let columns: Vec<&str> = row.split(" | ").map(str::trim).collect();
        let [edit, place, words] = columns[..] else {
            panic!("{row}")
        };
        let edit = edit.replace("\\n", "\n");
        let config = match edit.split_once(" => ") {
            Some((from, to)) => edited(base, from, to),
            None => format!("{base}{edit}\n"),
        };
        let error = error(&config);
        let (place, path) = place.rsplit_once(' ').unwrap_or(("", place));
        let is_there = error.to_string().starts_with(&format!("c.toml:{place}"));
        assert!(is_there && error.path == path, "{row}\n{error}");
        assert!(error.message.contains(words), "{row}\n{error}");
    }
}

#[test]
fn scenes_and_outputs() {
    assert_refused(SCENE, ROLLS);
    assert_refused(GLIDE, GLIDES);
}

/// For a plot that cannot be drawn, `check` and `run` print the same message as `plot`.
#[test]
fn plots() {
    assert_refused(STUDY, PLOTS);
    for row in PLOTS.trim().lines() {
        let (edit, words) = (row.split(" | ").next(), row.rsplit(" | ").next());
        let sections = edit.unwrap().replace("\\n", "\n");
        let (sweep, plot) = sections.split_at(sections.find("[[plot]]").unwrap());
        let desk = Desk::with(&format!("{STUDY}{sections}"));
        for command in ["check c.toml", "run c.toml --out o"] {
            desk.palpate(command).fails(2, words.unwrap());
        }
        assert_untouched(&desk.path(""));
        desk.write("c.toml", format!("{STUDY}{sweep}"));
        desk.palpate("run c.toml --out o").printed();
        desk.write("o/run.toml", format!("{}\n{plot}", desk.read("o/run.toml")));
        desk.palpate("plot o").fails(1, words.unwrap());
    }
}

#[test]
fn plots_that_trials_may_draw_are_not_refused() {
    for sections in [
        "[[plot]]\nx = \"truth\"\ny = \"mean\"\nquantity = \"normal_curvature_u\"\n",
        "[[plot]]\nx = \"scene.object.radius\"\ny = \"trials\"\nseries = \"quantity\"\n",
        "[[plot]]\nx = \"mean\"\ny = \"std\"\nquantity = \"arc_length\"\nscale = \"log-log\"\n",
        "[[sweep]]\npath = \"seed\"\nvalues = [1, 2]\n[[plot]]\nx = \"scene.object.radius\"\ny = \"mean\"\n\
         quantity = \"arc_length\"\nwhere = { seed = 2 }\n",
    ] {
        let desk = Desk::with(&format!("{STUDY}{sections}"));
        desk.palpate("run c.toml --out o").printed();
        desk.palpate("plot o").printed();
    }
}

#[test]
fn commands_print_the_error_and_write_nothing() {
    let bad = edited(SCENE, "50.0", "-50.0");
    let desk = Desk::with(&bad);
    let message = format!("error: {}\n", error(&bad));
    assert!(
        message.ends_with("radius = -50.0 }\n  |                                      ^^^^^\n")
    );
    for command in ["run c.toml", "check c.toml", "trace c.toml --out o"] {
        assert_eq!(desk.palpate(command).said(2), message);
    }
    assert_untouched(&desk.path(""));
    desk.write("c.toml", SCENE);
    desk.palpate("run c.toml --out o").printed();
    let before = desk.read("o/cells.csv");
    desk.write("c.toml", bad);
    for command in ["run", "trace"] {
        desk.palpate(&format!("{command} c.toml --out o")).said(2);
    }
    assert_eq!(desk.names("o").len(), 3);
    assert_eq!(desk.read("o/cells.csv"), before);
}
