//! Bad plots, and what is said about them to the letter.

use super::{BASE, message};

fn with(sections: &str) -> String {
    format!("{BASE}{sections}")
}

#[test]
fn plots_of_columns_that_do_not_exist() {
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, 2]
[[plot]]
x = "scene.object.radus"
y = "mean"
"#
        )),
        r#"study.toml:13:5: plot.0.x: no column `scene.object.radus`; did you mean `scene.object.radius`?
   |
13 | x = "scene.object.radus"
   |     ^^^^^^^^^^^^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, 2]
[[plot]]
x = "scene.object.radius"
y = "relative_rms"
"#
        )),
        r#"study.toml:14:5: plot.0.y: no column `relative_rms`; did you mean `relative_rms_error`?
   |
14 | y = "relative_rms"
   |     ^^^^^^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, 2]
[[plot]]
x = "truth"
y = "mean"
compare = "scene.object.radius"
"#
        )),
        r#"study.toml:15:11: plot.0.compare: no column `scene.object.radius`; known: truth, trials, failures, mean, std, bias, rms_error, rms_error_std, mean_abs_error, relative_rms_error, relative_mean_abs_error, q05, q50, q95, mean_reported_std, coverage50, coverage80, coverage95
   |
15 | compare = "scene.object.radius"
   |           ^^^^^^^^^^^^^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, 2]
[[plot]]
x = "truth"
y = "mean"
series = "kind"
"#
        )),
        r#"study.toml:15:10: plot.0.series: no column `kind`; known: scene.object.radius, truth, trials, failures, mean, std, bias, rms_error, rms_error_std, mean_abs_error, relative_rms_error, relative_mean_abs_error, q05, q50, q95, mean_reported_std, coverage50, coverage80, coverage95, quantity
   |
15 | series = "kind"
   |          ^^^^^^"#
    );
}

#[test]
fn plots_of_rows_that_do_not_exist() {
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, 2]
[[plot]]
x = "truth"
y = "mean"
where = { "scene.object.radius" = [1.0, 3] }
"#
        )),
        r#"study.toml:15:41: plot.0.where.scene.object.radius: no cell has 3; the sweep has 1, 2
   |
15 | where = { "scene.object.radius" = [1.0, 3] }
   |                                         ^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, 2]
[[plot]]
x = "truth"
y = "mean"
where.scene.object.radius = 1
"#
        )),
        r#"study.toml:15:7: plot.0.where.scene: no column `scene`; did you mean `scene.object.radius`?
   |
15 | where.scene.object.radius = 1
   |       ^^^^^"#
    );
}

#[test]
fn two_plots_of_one_name() {
    assert_eq!(
        message(&with(
            r#"[[plot]]
name = "p"
x = "truth"
y = "mean"
[[plot]]
name = "p"
x = "truth"
y = "std"
"#
        )),
        r#"study.toml:14:8: plot.1.name: another plot has this name
   |
14 | name = "p"
   |        ^^^"#
    );
}

#[test]
fn plots_without_the_keys_of_their_kind() {
    assert_eq!(
        message(&with(
            r#"[[plot]]
y = "mean"
"#
        )),
        r#"study.toml:9:1: plot.0.x: missing key
  |
9 | [[plot]]
  | ^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[plot]]
kind = "class-map"
x = "truth"
"#
        )),
        r#"study.toml:11:1: plot.0.x: unknown key for kind `class-map`; known: name, title, where, scale, kind
   |
11 | x = "truth"
   | ^"#
    );
    assert_eq!(
        message(&with(
            r#"[[plot]]
kind = "contact"
"#
        )),
        r#"study.toml:10:8: plot.0.kind: unknown choice "contact"; did you mean `contacts`? (known: lines, class-map, contacts, profile)
   |
10 | kind = "contact"
   |        ^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[plot]]
kind = "contacts"
scale = "log-x"
"#
        )),
        r#"study.toml:11:9: plot.0.scale: only lines have another scale than linear
   |
11 | scale = "log-x"
   |         ^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[plot]]
kind = "class-map"
"#
        )),
        r#"study.toml:10:8: plot.0.kind: is drawn from the output "map", which `outputs` does not ask for
   |
10 | kind = "class-map"
   |        ^^^^^^^^^^^"#
    );
}

#[test]
fn profiles_with_keys_of_lines_or_without_their_table() {
    assert_eq!(
        message(&with(
            r#"[[plot]]
kind = "profile"
x = "truth"
"#
        )),
        r#"study.toml:11:1: plot.0.x: unknown key for kind `profile`; known: name, title, component, panels, where, scale, marks, points, kind
   |
11 | x = "truth"
   | ^"#
    );
    assert_eq!(
        message(&with(
            r#"[[plot]]
kind = "profile"
component = "radial"
"#
        )),
        r#"study.toml:10:8: plot.0.kind: is drawn from the output "map", which `outputs` does not ask for
   |
10 | kind = "profile"
   |        ^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[plot]]
kind = "profile"
component = "tangential"
"#
        )),
        r#"study.toml:11:13: plot.0.component: unknown choice "tangential" (known: normal, radial)
   |
11 | component = "tangential"
   |             ^^^^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[plot]]
x = "truth"
y = "mean"
component = "radial"
"#
        )),
        r#"study.toml:12:1: plot.0.component: unknown key for kind `lines`; known: name, title, x, y, quantity, series, panels, where, scale, compare, marks, points, kind
   |
12 | component = "radial"
   | ^^^^^^^^^"#
    );
}

#[test]
fn points_that_are_no_pairs_or_belong_nowhere() {
    let points = |rest: &str| {
        message(&with(&format!(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, 2]
[[plot]]
x = "truth"
y = "mean"
series = "scene.object.radius"
[[plot.points]]
label = "published"
{rest}"#
        )))
    };
    assert_eq!(
        points("x = [1.0, 2]\ny = [1]\n"),
        r#"study.toml:19:5: plot.0.points.0.y: has 1 values, and `x` has 2
   |
19 | y = [1]
   |     ^^^"#
    );
    assert_eq!(
        points("x = []\ny = []\n"),
        r#"study.toml:18:5: plot.0.points.0.x: expected at least 1 item, found 0
   |
18 | x = []
   |     ^^"#
    );
    assert_eq!(
        points("x = [1]\ny = [inf]\n"),
        r#"study.toml:19:6: plot.0.points.0.y.0: must be finite, is inf
   |
19 | y = [inf]
   |      ^^^"#
    );
    assert_eq!(
        points("x = [1]\ny = [2]\nseries = \"3\"\n"),
        r#"study.toml:20:10: plot.0.points.0.series: no cell has 3; the sweep has 1, 2
   |
20 | series = "3"
   |          ^^^"#
    );
    assert_eq!(
        points("x = [1]\ny = [2]\npanel = \"1\"\n"),
        r#"study.toml:20:9: plot.0.points.0.panel: the plot has no `panels`
   |
20 | panel = "1"
   |         ^^^"#
    );
}
