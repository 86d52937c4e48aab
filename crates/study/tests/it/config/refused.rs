//! Tests the errors of invalid configs: the position in the text, the field and the reason.

use palpate_study::config::parse;

use super::{BASE, error, refuses};

/// One complete message for each kind of error.
const MESSAGES: &str = r#"
radius = 5.0 } => radius = 5.0 ] | 7:42 | invalid inline table element, expected `,`
5.0 => 99999999999999999999 | 7:38 scene.object.radius | the integer 99999999999999999999 does not fit into 64 bits
radius = 5.0 => radus = 5.0 | 7:29 scene.object.radus | unknown key for kind `sphere`; did you mean `radius`? (known: kind, radius)
radius = 5.0 => radius = 5.0, colour = 1 | 7:43 scene.object.colour | unknown key for kind `sphere`; known: kind, radius
[scene] => [scen] | 4:2 scen | unknown key; did you mean `scene`?
"sphere", radius = 5.0 => "plane", radius = 5.0 | 7:28 scene.object.radius | unknown key for kind `plane`; known: kind; kinds sphere, dish, cylinder have it
kind = "sphere", radius = 5.0 => kind = "elipsoid" | 7:19 scene.object.kind | unknown kind "elipsoid"; did you mean `ellipsoid`? (known: sphere, dish, plane, cylinder, ellipsoid, torus, paraboloid, saddle, height-field)
"cm" => "ft" | 2:15 length_unit | unknown choice "ft" (known: m, cm, mm, um, unit)
5.0 => "five" | 7:38 scene.object.radius | expected a number, found the string "five"
{ kind = "sphere", radius = 1.0 } => 3 | 6:9 scene.probe | expected a table with `kind`, found the integer 3
[sweep]\npath = "seed" | 9:1 sweep | expected an array of tables, in [[double]] brackets, found a table
, radius = 5.0 => | 7:10 scene.object.radius | missing key
probe = { kind = "sphere", radius = 1.0 } => | 4:1 scene.probe | missing table
object = { kind = "sphere", => object = { | 7:10 scene.object.kind | missing key, one of sphere, dish, plane, cylinder, ellipsoid, torus, paraboloid, saddle, height-field
5.0 => -5.0 | 7:38 scene.object.radius | must be > 0, is -5
5.0 => 1e999 | 7:38 scene.object.radius | must be finite, is inf
kind = "sphere", radius = 5.0 => kind = "ellipsoid", semi_axes = [1, 2] | 7:44 scene.object.semi_axes | expected 3 items, found 2
duration_s = 1.0 => duration_s = 1.0, directions_deg = [] | 8:69 scene.motion.directions_deg | expected at least 1 item, found 0
a-study => A study | 1:8 name | "A study" is not a name: lower-case letters and digits, joined by single hyphens, at most 100
duration_s = 1.0 => duration_s = 1.0, arc_length = 2 | 8:65 scene.motion.arc_length | cannot be combined with `duration_s`; keep one of them
, duration_s = 1.0 => | 8:10 scene.motion | needs `duration_s`, `arc_length` or `angle_deg`
rate_rad_per_s = 0.1, => | 8:10 scene.motion.rate_rad_per_s | missing key; `duration_s` needs it
duration_s = 1.0 => duration_s = 1.0, axis = "chart" | 8:59 scene.motion.axis | "chart" needs a model that uses the probe's chart: `scene.model` with chart = "montana"
[[sweep]]\npath = "name"\nvalues = ["b"] | 10:8 sweep.0 | cannot sweep `name`; a sweep sets fields of `scene`, `seed` or `trials`
[[sweep]]\npath = "scene.objct.radius"\nvalues = [1] | 10:8 scene.objct.radius | the sweep path does not exist: `scene` has no `objct`; did you mean `object`?
[[sweep]]\npath = "scene.object"\nvalues = [{ kind = "plane" }] | 11:11 sweep.0.values.0 | a table among swept values needs a `label`, which the results show
[[sweep]]\npath = "scene.noise.rotatoin.std_deg"\nvalues = [1] | 10:8 scene.noise.rotatoin.std_deg | `scene.noise` has no `rotatoin`; did you mean `rotation`? (known: angular_velocity, encoder, rotation)
[[plot]]\nx = "truth"\ny = "relative_rms" | 11:5 plot.0.y | no column `relative_rms`; did you mean `relative_rms_error`?
[[plot]]\nkind = "class-map" | 10:8 plot.0.kind | needs the output "map", which `outputs` does not list
"#;

const FIELDS: &str = r#"
length_unit => name | 2:1 | duplicate key
"cm" => "CM" | 2:15 length_unit | did you mean `cm`?
kind = "sphere", radius = 5.0 => kind = "cube" | 7:19 scene.object.kind | unknown kind "cube" (known
"a-study" => 1 | 1:8 name | expected a string
length_unit => trials = 10.5\nlength_unit | 2:10 trials | expected an integer
length_unit => crate_version = "99.0.0"\nlength_unit | 2:17 crate_version | of version 99.0.0
length_unit => crate_version = "old"\nlength_unit | 2:17 crate_version | is not a version
sensor = { kind = 1 } | 9:19 scene.sensor.kind | expected a string
length_unit => columns = { shift = "U" }\nlength_unit | 2:21 columns.shift | no column of these readings
length_unit => seed = -1\nlength_unit | 2:8 seed | must be >= 0
length_unit => claims = [1, 5000000000]\nlength_unit | 2:14 claims.1 | must be <= 4294967295
sensor = { kind = "pads", pitch = 0.1, cap_deg = 180.5 } | 9:50 scene.sensor.cap_deg | must be <= 180
noise = { angular_velocity = { kind = "uniform", fraction = -0.01 } } | 9:61 scene.noise.angular_velocity.fraction | must be >= 0
kind = "sphere", radius = 5.0 => kind = "ellipsoid", semi_axes = [1, 2, -3] | 7:51 scene.object.semi_axes.2 | must be > 0
rate_rad_per_s = 0.1, duration_s = 1.0 => arc_length = 1, spin_rad_per_s = 1 | 8:10 scene.motion.rate_rad_per_s | `spin_rad_per_s`
rate_rad_per_s = 0.1, duration_s = 1.0 => angle_deg = 1, sampling_hz = 100 | 8:10 scene.motion.rate_rad_per_s | `sampling_hz`
estimator = { kind = "trajectory" } | 8:10 scene.motion.sampling_hz | needs rolls as time series
estimator = { kind = "auto", start = "stated" } | 9:38 scene.estimator.start | unknown choice "stated" (known: unknown, known)
"#;

const SWEEPS: &str = r#"
[[sweep]] | 9:1 sweep.0 | is empty
[[sweep]]\npath = "scene.object.radius"\nvalues = [] | 11:10 sweep.0.values | at least 1 item
[[sweep]]\nvalues = [1] | 9:1 sweep.0 | needs `path` or `paths`
[[sweep]]\npath = "seed"\npaths = ["seed"]\nvalues = [1] | 9:1 sweep.0 | both `path` and `paths`
[[sweep]]\npath = "scene.object.radius"\nvalues = [1]\nfrom = 2 | 9:1 sweep.0 | both `values` and `from`
[[sweep]]\npath = "scene.object.radius"\nvalues = [1, 2, 1.0] | 11:17 sweep.0 | 1 occurs twice
[[sweep]]\npath = "scene.noise.angular_velocity.fraction"\nvalues = [1] | 10:8 scene.noise.angular_velocity.fraction | set `scene.noise.angular_velocity.kind` too
[[sweep]]\npath = "scene.object.parameters.k"\nvalues = [1] | 10:8 scene.object.parameters.k | only kind height-field has `parameters`; write it there
[[sweep]]\npath = "scene.object.radius.x"\nvalues = [1] | 10:8 scene.object.radius.x | does not exist: `scene.object.radius` is the number 5
[[sweep]]\npath = "scene.motion.directions_deg.8"\nvalues = [1] | 10:8 scene.motion.directions_deg.8 | has no item `8`
[[sweep]]\npath = ""\nvalues = [1] | 10:8 sweep.0 | cannot sweep
[[sweep]]\npath = "seed"\nvalues = [1]\n[[sweep]]\npath = "seed"\nvalues = [3] | 13:8 sweep.1 | is swept twice
[[sweep]]\npath = "scene.object.radius"\nvalues = [1]\n[[sweep]]\npath = "scene.object"\nvalues = [1] | 13:8 sweep.1 | would overwrite
[[sweep]]\npath = "scene.motion.angle_deg"\nvalues = [5]\n[[sweep]]\npath = "scene.motion.arc_length"\nvalues = [1] | 14:11 scene.motion.arc_length | cannot be combined with
[[sweep]]\npaths = ["scene.object.radius", "seed"]\nvalues = [[1, 2], [3]] | 11:19 sweep.0.values.1 | expected 2 values
[[sweep]]\npaths = ["scene.object.radius", "seed"]\nvalues = [1, 2] | 11:11 sweep.0.values.0 | expected an array
[[sweep]]\npaths = ["seed"]\nfrom = 1\nto = 2\ncount = 2 | 9:1 sweep.0 | `paths` needs `values`
[[sweep]]\npath = "scene.object.radius"\nvalues = [1, 2,\n  -3] | 12:3 scene.object.radius | must be > 0
[[sweep]]\npath = "scene.object.radius"\nfrom = 1\nto = -1\ncount = 3 | 13:9 scene.object.radius | must be > 0
[[sweep]]\npath = "scene.object"\nvalues = [{ label = 1, kind = "plane" }] | 11:21 sweep.0.values.0.label | not empty
[[sweep]]\npath = "scene.object"\nvalues = [{ label = "a", kind = "plane" }, { label = "a", kind = "dish", radius = 9 }] | 11:44 sweep.0 | a occurs twice
[[sweep]]\npath = "scene.object"\nvalues = [{ label = "a", kind = "plane" }, { label = "b", kind = "dish" }] | 11:44 scene.object.radius | missing key
[[sweep]]\npath = "scene.object.kind"\nvalues = ["sphere", "plane"] | 7:29 scene.object.radius | unknown key for kind `plane`
[[sweep]]\npath = "scene.object.radius"\nfrom = 0\nto = 2\ncount = 3\nspacing = "log" | 11:8 sweep.0.from | must be > 0 where spacing
[[sweep]]\npath = "scene.object.radius"\nfrom = 1\nto = 2\ncount = 1 | 13:9 sweep.0.count | needs at least 2 values
[[sweep]]\npath = "scene.object.radius"\nfrom = 1\ncount = 2 | 9:1 sweep.0.to | missing key
[[sweep]]\npath = "scene.object.radius"\nfrom = 1\nto = 1\ncount = 2 | 12:6 sweep.0 | 1 occurs twice
object => objct | 7:1 scene.objct | did you mean `object`?
[[sweep]]\npath = "seed"\nfrom = 1\nto = 1001\ncount = 1001\n[[sweep]]\npath = "trials"\nfrom = 1\nto = 1000\ncount = 1000 | 14:1 sweep.1 | 1001000 cells
[[sweep]]\npath = "scene.object.radius"\nfrom = 1\nto = 2\ncount = 4294967295 | 9:1 sweep.0 | at most 1000000
"#;

const SWEPT: &str = "[[sweep]]\npath = \"scene.object.radius\"\nvalues = [1, 2]\n";

const PLOTS: &str = r#"
[[plot]]\nx = "scene.object.radus"\ny = "mean" | 13:5 plot.0.x | did you mean `scene.object.radius`?
[[plot]]\nx = "truth"\ny = "mean"\ncompare = "scene.object.radius" | 15:11 plot.0.compare | no column `scene.object.radius`
[[plot]]\nx = "truth"\ny = "mean"\nseries = "kind" | 15:10 plot.0.series | no column `kind`; known: scene.object.radius, truth,
[[plot]]\nx = "truth"\ny = "mean"\nwhere = { "scene.object.radius" = [1.0, 3] } | 15:41 plot.0.where.scene.object.radius | no cell has 3
[[plot]]\nx = "truth"\ny = "mean"\nwhere.scene.object.radius = 1 | 15:7 plot.0.where.scene | no column `scene`
[[plot]]\nname = "p"\nx = "truth"\ny = "mean"\n[[plot]]\nname = "p"\nx = "truth"\ny = "std" | 17:8 plot.1.name | has this name
[[plot]]\ny = "mean" | 12:1 plot.0.x | missing key
[[plot]]\nkind = "class-map"\nx = "truth" | 14:1 plot.0.x | unknown key for kind `class-map`
[[plot]]\nkind = "contact" | 13:8 plot.0.kind | did you mean `contacts`?
[[plot]]\nkind = "contacts"\nscale = "log-x" | 14:9 plot.0.scale | only lines
[[plot]]\nkind = "profile"\nx = "truth" | 14:1 plot.0.x | unknown key for kind `profile`
[[plot]]\nkind = "profile"\ncomponent = "radial" | 13:8 plot.0.kind | "map"
[[plot]]\nkind = "profile"\ncomponent = "tangential" | 14:13 plot.0.component | known: normal, radial
[[plot]]\nx = "truth"\ny = "mean"\ncomponent = "radial" | 15:1 plot.0.component | unknown key for kind `lines`
[[plot]]\nx = "truth"\ny = "mean"\npoints = [{ label = "p", x = [1, 2], y = [1] }] | 15:42 plot.0.points.0.y | has 1 values
[[plot]]\nx = "truth"\ny = "mean"\npoints = [{ label = "p", x = [], y = [] }] | 15:30 plot.0.points.0.x | at least 1 item
[[plot]]\nx = "truth"\ny = "mean"\npoints = [{ label = "p", x = [1], y = [inf] }] | 15:40 plot.0.points.0.y.0 | must be finite
[[plot]]\nx = "truth"\ny = "mean"\nseries = "scene.object.radius"\npoints = [{ label = "p", x = [1], y = [2], series = "3" }] | 16:53 plot.0.points.0.series | no cell has 3
[[plot]]\nx = "truth"\ny = "mean"\npoints = [{ label = "p", x = [1], y = [2], panel = "1" }] | 15:52 plot.0.points.0.panel | no `panels`
[[plot]]\nx = "truth"\ny = "std_bound" | 14:5 plot.0.y | no column `std_bound`
"#;

/// Config of a press. A test uses it, and the config `GLIDE` of a glide, to check plots that only one kind of scene can
/// have.
const PRESS: &str = r#"name = "a-press"
outputs = ["cells", "map", "trace"]
[scene]
kind = "press"
probe = { kind = "marker-sphere", radius = 20, marker_depth = 2 }
object = { kind = "plane" }
motion = { indentation = 1 }
"#;
const GLIDE: &str = r#"name = "a-glide"
outputs = ["cells", "map", "trace"]
[scene]
kind = "glide"
probe = { kind = "sphere", radius = 4.0 }
object = { kind = "saddle", a = 0.01 }
motion = { finger_positions = [-15.0, 0.0, 15.0], inter_finger_distance = 10.0, patch_length = 30.0, contacts_per_finger = 10 }
evaluate = { half_width = 10.0, gaussian_threshold = 0.00005, mean_threshold = 0.003 }
"#;

const POINTS: &str = r#"[[sweep]]
sample = "sobol"
count = 256
ranges."scene.object.radius" = { from = 2, to = 10 }
ranges."scene.motion.rate_rad_per_s" = { from = 0.01, to = 1.0, spacing = "log" }
"#;
const SAMPLES: &str = r#"
count = 256 => count = 70000 | 11:9 sweep.0.count | must be <= 65536
count = 256 => | 9:1 sweep.0.count | missing key
sample = "sobol" => | 9:1 sweep.0.sample | missing key
"sobol" => "sobel" | 10:10 sweep.0.sample | did you mean `sobol`?
from = 2 => from = 10 | 12:32 sweep.0.ranges.scene.object.radius | must be < `to`
from = 0.01 => from = 0.0 | 13:40 sweep.0.ranges.scene.motion.rate_rad_per_s | must be > 0 where spacing
from = 2, => | 12:32 sweep.0.ranges.scene.object.radius.from | missing key
count = 256 => count = 256\npath = "seed" | 9:1 sweep.0 | both `ranges` and `path`
object.radius" => object.radios" | 12:8 scene.object.radios | unknown key
[[sweep]]\npath = "scene.object.radius"\nvalues = [3] | 15:8 sweep.1 | is swept twice
"#;

const RULE: &str = "stop = { relative_standard_error = 0.01, max_trials = 50000 }\n";
const RULES: &str = r#"
name => trials = 7\nname | 2:10 trials | differs from `stop.max_trials`
[[sweep]]\npath = "trials"\nvalues = [3] | 11:8 trials | `stop` decides
0.01 => 0.0 | 1:36 stop.relative_standard_error | must be > 0
max_trials = 50000 => max_trials = 9, min_trials = 10 | 1:71 stop.min_trials | must be <= max_trials
, max_trials = 50000 => | 1:8 stop.max_trials | missing key
50000 => 9, statistic = "median" | 1:70 stop.statistic | unknown choice
"#;

#[test]
fn bad_fields() {
    refuses(BASE, MESSAGES);
    refuses(BASE, FIELDS);
    for version in ["0.0.1", env!("CARGO_PKG_VERSION")] {
        let text = format!("crate_version = \"{version}\"\n{BASE}");
        parse("study.toml", &text).unwrap();
    }
    for text in ["", "# only a comment\n"] {
        assert!(error(text).message.starts_with("the config is empty"));
    }
    refuses(
        "",
        "title = \"x\" | name | missing key\nname = \"x\" | scene | missing table",
    );
}

#[test]
fn bad_sweeps() {
    refuses(BASE, SWEEPS);
    refuses(&format!("{BASE}{POINTS}"), SAMPLES);
    refuses(&format!("{RULE}{BASE}"), RULES);
}

#[test]
fn bad_plots() {
    refuses(&format!("{BASE}{SWEPT}"), PLOTS);
    let map = r#"[[plot]]\nkind = "profile" | 10:8 plot.0.kind | a scene of kind press"#;
    refuses(GLIDE, map);
    let presses = r#"
marker_depth = 2 => marker_depth = 2, layout = "hexagon" | 5:75 scene.probe.layout | or a table whose `kind` is one of gores
marker_depth = 2 => marker_depth = 2, layout = { kind = "lattice", pitch = 1, cap = 60 } | 5:106 scene.probe.layout.cap | did you mean `cap_deg`?
[[plot]]\nkind = "class-map" | 9:8 plot.0.kind | a scene of kind glide
[[plot]]\nkind = "contacts" | 9:8 plot.0.kind | a scene of kind glide
"#;
    refuses(PRESS, presses);
    for (base, plot) in [
        (PRESS, "kind = \"profile\""),
        (
            PRESS,
            "x = \"std_bound\"\ny = \"std\"\ncompare = \"std_bound\"",
        ),
        (GLIDE, "kind = \"class-map\""),
        (GLIDE, "kind = \"contacts\""),
    ] {
        let text = format!("{base}[[plot]]\n{plot}\n");
        parse("study.toml", &text).unwrap();
    }
}

#[test]
fn messages_show_the_line_and_the_cell() {
    let sweep = "[[sweep]]\npath = \"seed\"\nvalues = [1, 2]\n[[sweep]]\npath = \"scene.object.radius\"\nvalues = [1, -3]\n";
    assert_eq!(
        error(&format!("{BASE}{sweep}")).to_string(),
        r#"study.toml:14:14: scene.object.radius: must be > 0, is -3
   |
14 | values = [1, -3]
   |              ^^
   = in cell 1: seed = 1, scene.object.radius = -3"#
    );
}
