//! Bad sweeps, and what is said about them to the letter.

use super::{BASE, message};

fn with(sections: &str) -> String {
    format!("{BASE}{sections}")
}

#[test]
fn sweeps_that_are_empty_or_double() {
    assert_eq!(
        message(&with(
            r#"[[sweep]]
"#
        )),
        r#"study.toml:9:1: sweep.0: is empty: needs `values`, or `from`, `to` and `count`
  |
9 | [[sweep]]
  | ^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = []
"#
        )),
        r#"study.toml:11:10: sweep.0.values: expected at least 1 item, found 0
   |
11 | values = []
   |          ^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
values = [1]
"#
        )),
        r#"study.toml:9:1: sweep.0: needs `path` or `paths`
  |
9 | [[sweep]]
  | ^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "seed"
paths = ["seed"]
values = [1]
"#
        )),
        r#"study.toml:9:1: sweep.0: has both `path` and `paths`; keep one of them
  |
9 | [[sweep]]
  | ^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1]
from = 2
"#
        )),
        r#"study.toml:9:1: sweep.0: has both `values` and `from`; keep one form
  |
9 | [[sweep]]
  | ^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, 2, 1.0]
"#
        )),
        r#"study.toml:11:17: sweep.0: 1 stands twice on this axis
   |
11 | values = [1, 2, 1.0]
   |                 ^^^"#
    );
}

#[test]
fn sweep_paths_that_name_nothing() {
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.objct.radius"
values = [1]
"#
        )),
        r#"study.toml:10:8: scene.objct.radius: the sweep path names nothing: `scene` has no `objct`; did you mean `object`?
   |
10 | path = "scene.objct.radius"
   |        ^^^^^^^^^^^^^^^^^^^^
   = in cell 0: scene.objct.radius = 1"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radus"
values = [1]
"#
        )),
        r#"study.toml:10:8: scene.object.radus: unknown key for kind `sphere`; did you mean `radius`?
   |
10 | path = "scene.object.radus"
   |        ^^^^^^^^^^^^^^^^^^^^
   = in cell 0: scene.object.radus = 1"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius.x"
values = [1]
"#
        )),
        r#"study.toml:10:8: scene.object.radius.x: the sweep path names nothing: `scene.object.radius` is the number 5, which has no `x`
   |
10 | path = "scene.object.radius.x"
   |        ^^^^^^^^^^^^^^^^^^^^^^^
   = in cell 0: scene.object.radius.x = 1"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.motion.directions_deg.8"
values = [1]
"#
        )),
        r#"study.toml:10:8: scene.motion.directions_deg.8: the sweep path names nothing: `scene.motion.directions_deg` is an array of 8, which has no item `8`
   |
10 | path = "scene.motion.directions_deg.8"
   |        ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
   = in cell 0: scene.motion.directions_deg.8 = 1"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = ""
values = [1]
"#
        )),
        r#"study.toml:10:8: sweep.0: cannot sweep ``; a sweep sets fields of `scene`, `seed` or `trials`
   |
10 | path = ""
   |        ^^"#
    );
}

#[test]
fn a_misspelt_table_is_found_before_the_sweep_into_it() {
    assert_eq!(
        message(
            &with(
                r#"[[sweep]]
path = "scene.object.radius"
values = [1]
"#
            )
            .replace("object =", "objct =")
        ),
        r#"study.toml:7:1: scene.objct: unknown key for kind `roll`; did you mean `object`?
  |
7 | objct = { kind = "sphere", radius = 5.0 }
  | ^^^^^"#
    );
}

#[test]
fn sweep_paths_that_are_taken() {
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "name"
values = ["b"]
"#
        )),
        r#"study.toml:10:8: sweep.0: cannot sweep `name`; a sweep sets fields of `scene`, `seed` or `trials`
   |
10 | path = "name"
   |        ^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "plot.0.x"
values = ["b"]
"#
        )),
        r#"study.toml:10:8: sweep.0: cannot sweep `plot.0.x`; a sweep sets fields of `scene`, `seed` or `trials`
   |
10 | path = "plot.0.x"
   |        ^^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, 2]
[[sweep]]
path = "scene.object.radius"
values = [3]
"#
        )),
        r#"study.toml:13:8: sweep.1: `scene.object.radius` is swept twice
   |
13 | path = "scene.object.radius"
   |        ^^^^^^^^^^^^^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, 2]
[[sweep]]
path = "scene.object"
values = [1]
"#
        )),
        r#"study.toml:13:8: sweep.1: `scene.object` would overwrite `scene.object.radius`, which is swept before it
   |
13 | path = "scene.object"
   |        ^^^^^^^^^^^^^^"#
    );
}

#[test]
fn rows_of_a_wrong_length() {
    assert_eq!(
        message(&with(
            r#"[[sweep]]
paths = ["scene.object.radius", "seed"]
values = [[1, 2], [3]]
"#
        )),
        r#"study.toml:11:19: sweep.0.values.1: expected 2 values, one for each of `paths`, found 1
   |
11 | values = [[1, 2], [3]]
   |                   ^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
paths = ["scene.object.radius", "seed"]
values = [1, 2]
"#
        )),
        r#"study.toml:11:11: sweep.0.values.0: expected an array with one value for each of `paths`, found the integer 1
   |
11 | values = [1, 2]
   |           ^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
paths = ["seed"]
from = 1
to = 2
count = 2
"#
        )),
        r#"study.toml:9:1: sweep.0: a range sets one field; `paths` needs `values`
  |
9 | [[sweep]]
  | ^^^^^^^^^"#
    );
}

#[test]
fn swept_values_point_into_their_list() {
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, 2,
  -3]
"#
        )),
        r#"study.toml:12:3: scene.object.radius: must be > 0, is -3
   |
12 |   -3]
   |   ^^
   = in cell 2: scene.object.radius = -3"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, nan]
"#
        )),
        r#"study.toml:11:14: scene.object.radius: must be finite, is nan
   |
11 | values = [1, nan]
   |              ^^^
   = in cell 1: scene.object.radius = nan"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
values = [1, "two"]
"#
        )),
        r#"study.toml:11:14: scene.object.radius: expected a number, found the string "two"
   |
11 | values = [1, "two"]
   |              ^^^^^
   = in cell 1: scene.object.radius = two"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
from = 1
to = -1
count = 3
"#
        )),
        r#"study.toml:13:9: scene.object.radius: must be > 0, is 0
   |
13 | count = 3
   |         ^
   = in cell 1: scene.object.radius = 0"#
    );
}

#[test]
fn labels() {
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object"
values = [{ kind = "plane" }]
"#
        )),
        r#"study.toml:11:11: sweep.0.values.0: a table among swept values needs a `label`, which the results show
   |
11 | values = [{ kind = "plane" }]
   |           ^^^^^^^^^^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object"
values = [{ label = 1, kind = "plane" }]
"#
        )),
        r#"study.toml:11:21: sweep.0.values.0.label: expected a text that is not empty, found the integer 1
   |
11 | values = [{ label = 1, kind = "plane" }]
   |                     ^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object"
values = [{ label = "a", kind = "plane" }, { label = "a", kind = "dish", radius = 9 }]
"#
        )),
        r#"study.toml:11:44: sweep.0: a stands twice on this axis
   |
11 | values = [{ label = "a", kind = "plane" }, { label = "a", kind = "dish", radius = 9 }]
   |                                            ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object"
values = [{ label = "a", kind = "plane" }, { label = "b", kind = "dish" }]
"#
        )),
        r#"study.toml:11:44: scene.object.radius: missing key
   |
11 | values = [{ label = "a", kind = "plane" }, { label = "b", kind = "dish" }]
   |                                            ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
   = in cell 1: scene.object = b"#
    );
}

#[test]
fn the_cell_is_named_where_its_values_matter() {
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.probe.radius"
values = [1, 2]
[[sweep]]
path = "scene.object.kind"
values = ["sphere", "plane"]
"#
        )),
        r#"study.toml:7:29: scene.object.radius: unknown key for kind `plane`; known: kind; kinds sphere, dish, cylinder have it
  |
7 | object = { kind = "sphere", radius = 5.0 }
  |                             ^^^^^^
  = in cell 1: scene.probe.radius = 1, scene.object.kind = plane"#
    );
}

#[test]
fn ranges() {
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
from = 0
to = 2
count = 3
spacing = "log"
"#
        )),
        r#"study.toml:11:8: sweep.0.from: must be > 0 where spacing = "log", is 0
   |
11 | from = 0
   |        ^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
from = 1
to = 2
count = 1
"#
        )),
        r#"study.toml:13:9: sweep.0.count: 1 value cannot reach from 1 to 2
   |
13 | count = 1
   |         ^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
from = 1
count = 2
"#
        )),
        r#"study.toml:9:1: sweep.0.to: missing key; a range needs `from`, `to` and `count`
  |
9 | [[sweep]]
  | ^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
from = 1
to = 2
count = 0
"#
        )),
        r#"study.toml:13:9: sweep.0.count: must be >= 1, is 0
   |
13 | count = 0
   |         ^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
from = 1
to = 1
count = 2
"#
        )),
        r#"study.toml:12:6: sweep.0: 1 stands twice on this axis
   |
12 | to = 1
   |      ^"#
    );
    assert_eq!(
        message(&with(
            r#"[[sweep]]
path = "scene.object.radius"
from = 1
to = inf
count = 2
"#
        )),
        r#"study.toml:12:6: sweep.0.to: must be finite, is inf
   |
12 | to = inf
   |      ^^^"#
    );
}
