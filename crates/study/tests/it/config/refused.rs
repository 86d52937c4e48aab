//! Bad configs, and what is said about them to the letter.

use super::{BASE, edited, message};

fn with(sections: &str) -> String {
    format!("{BASE}{sections}")
}

#[test]
fn syntax() {
    assert_eq!(
        message(&edited("radius = 5.0 }", "radius = 5.0 ]")),
        r#"study.toml:7:42: invalid inline table element, expected `,`
  |
7 | object = { kind = "sphere", radius = 5.0 ]
  |                                          ^"#
    );
    assert_eq!(
        message(&edited("length_unit", "name")),
        r#"study.toml:2:1: duplicate key
  |
2 | name = "cm"
  | ^^^^"#
    );
    assert_eq!(
        message(&edited("5.0", "99999999999999999999")),
        r#"study.toml:7:38: scene.object.radius: the integer 99999999999999999999 does not fit into 64 bits
  |
7 | object = { kind = "sphere", radius = 99999999999999999999 }
  |                                      ^^^^^^^^^^^^^^^^^^^^"#
    );
}

#[test]
fn a_config_with_little_or_nothing_in_it() {
    assert_eq!(
        message(""),
        "study.toml: the config is empty; it needs a `name` and a table `[scene]`"
    );
    assert_eq!(
        message(
            r#"# only a comment
"#
        ),
        "study.toml: the config is empty; it needs a `name` and a table `[scene]`"
    );
    assert_eq!(
        message(
            r#"title = "x"
"#
        ),
        "study.toml: name: missing key"
    );
    assert_eq!(
        message(
            r#"name = "x"
"#
        ),
        "study.toml: scene: missing table"
    );
}

#[test]
fn unknown_keys_name_the_nearest() {
    assert_eq!(
        message(&edited("radius = 5.0", "radus = 5.0")),
        r#"study.toml:7:29: scene.object.radus: unknown key for kind `sphere`; did you mean `radius`?
  |
7 | object = { kind = "sphere", radus = 5.0 }
  |                             ^^^^^"#
    );
    assert_eq!(
        message(&edited("radius = 5.0", "radius = 5.0, colour = 1")),
        r#"study.toml:7:43: scene.object.colour: unknown key for kind `sphere`; known: kind, radius
  |
7 | object = { kind = "sphere", radius = 5.0, colour = 1 }
  |                                           ^^^^^^"#
    );
    assert_eq!(
        message(&edited("[scene]", "[scen]")),
        r#"study.toml:4:2: scen: unknown key; did you mean `scene`?
  |
4 | [scen]
  |  ^^^^"#
    );
    assert_eq!(
        message(&edited(
            r#"{ kind = "sphere", radius = 5.0 }"#,
            r#"{ kind = "plane", radius = 5.0 }"#
        )),
        r#"study.toml:7:28: scene.object.radius: unknown key for kind `plane`; known: kind; kinds sphere, dish, cylinder have it
  |
7 | object = { kind = "plane", radius = 5.0 }
  |                            ^^^^^^"#
    );
}

#[test]
fn unknown_kinds_and_choices_list_the_known() {
    assert_eq!(
        message(&edited(
            r#"{ kind = "sphere", radius = 5.0 }"#,
            r#"{ kind = "elipsoid" }"#
        )),
        r#"study.toml:7:19: scene.object.kind: unknown kind "elipsoid"; did you mean `ellipsoid`? (known: sphere, dish, plane, cylinder, ellipsoid, torus, paraboloid, saddle, height-field)
  |
7 | object = { kind = "elipsoid" }
  |                   ^^^^^^^^^^"#
    );
    assert_eq!(
        message(&edited(
            r#"{ kind = "sphere", radius = 5.0 }"#,
            r#"{ kind = "cube" }"#
        )),
        r#"study.toml:7:19: scene.object.kind: unknown kind "cube" (known: sphere, dish, plane, cylinder, ellipsoid, torus, paraboloid, saddle, height-field)
  |
7 | object = { kind = "cube" }
  |                   ^^^^^^"#
    );
    assert_eq!(
        message(&edited(r#""cm""#, r#""CM""#)),
        r#"study.toml:2:15: length_unit: unknown choice "CM"; did you mean `cm`? (known: m, cm, mm, um, unit)
  |
2 | length_unit = "CM"
  |               ^^^^"#
    );
    assert_eq!(
        message(&edited(r#""cm""#, r#""ft""#)),
        r#"study.toml:2:15: length_unit: unknown choice "ft" (known: m, cm, mm, um, unit)
  |
2 | length_unit = "ft"
  |               ^^^^"#
    );
}

#[test]
fn wrong_types() {
    assert_eq!(
        message(&edited("5.0", r#""five""#)),
        r#"study.toml:7:38: scene.object.radius: expected a number, found the string "five"
  |
7 | object = { kind = "sphere", radius = "five" }
  |                                      ^^^^^^"#
    );
    assert_eq!(
        message(&edited(r#"{ kind = "sphere", radius = 1.0 }"#, "3")),
        r#"study.toml:6:9: scene.probe: expected a table with `kind`, found the integer 3
  |
6 | probe = 3
  |         ^"#
    );
    assert_eq!(
        message(&edited(r#""a-study""#, "1")),
        r#"study.toml:1:8: name: expected a string, found the integer 1
  |
1 | name = 1
  |        ^"#
    );
    assert_eq!(
        message(&edited(
            "length_unit",
            r#"trials = 10.5
length_unit"#
        )),
        r#"study.toml:2:10: trials: expected an integer, found the number 10.5
  |
2 | trials = 10.5
  |          ^^^^"#
    );
    assert_eq!(
        message(&edited(
            "length_unit",
            r#"claims = 3
length_unit"#
        )),
        r#"study.toml:2:10: claims: expected an array, found the integer 3
  |
2 | claims = 3
  |          ^"#
    );
    assert_eq!(
        message(&with("sensor = { kind = 1 }")),
        r#"study.toml:9:19: scene.sensor.kind: expected a string, found the integer 1
  |
9 | sensor = { kind = 1 }
  |                   ^"#
    );
    assert_eq!(
        message(&with(
            r#"[sweep]
path = "seed""#
        )),
        r#"study.toml:9:1: sweep: expected an array of tables, in [[double]] brackets, found a table
  |
9 | [sweep]
  | ^^^^^^^"#
    );
}

#[test]
fn missing_keys_and_tables_name_their_table() {
    assert_eq!(
        message(&edited(
            r#"probe = { kind = "sphere", radius = 1.0 }
"#,
            ""
        )),
        r#"study.toml:4:1: scene.probe: missing table
  |
4 | [scene]
  | ^^^^^^^"#
    );
    assert_eq!(
        message(&edited(", radius = 5.0", "")),
        r#"study.toml:7:10: scene.object.radius: missing key
  |
7 | object = { kind = "sphere" }
  |          ^^^^^^^^^^^^^^^^^^^"#
    );
    assert_eq!(
        message(&edited(r#"object = { kind = "sphere", "#, "object = { ")),
        r#"study.toml:7:10: scene.object.kind: missing key, one of sphere, dish, plane, cylinder, ellipsoid, torus, paraboloid, saddle, height-field
  |
7 | object = { radius = 5.0 }
  |          ^^^^^^^^^^^^^^^^"#
    );
}

#[test]
fn numbers_out_of_range() {
    assert_eq!(
        message(&edited("5.0", "-5.0")),
        r#"study.toml:7:38: scene.object.radius: must be > 0, is -5
  |
7 | object = { kind = "sphere", radius = -5.0 }
  |                                      ^^^^"#
    );
    assert_eq!(
        message(&edited("5.0", "0")),
        r#"study.toml:7:38: scene.object.radius: must be > 0, is 0
  |
7 | object = { kind = "sphere", radius = 0 }
  |                                      ^"#
    );
    assert_eq!(
        message(&edited(
            "length_unit",
            r#"trials = 0
length_unit"#
        )),
        r#"study.toml:2:10: trials: must be >= 1, is 0
  |
2 | trials = 0
  |          ^"#
    );
    assert_eq!(
        message(&edited(
            "length_unit",
            r#"seed = -1
length_unit"#
        )),
        r#"study.toml:2:8: seed: must be >= 0, is -1
  |
2 | seed = -1
  |        ^^"#
    );
    assert_eq!(
        message(&edited(
            "length_unit",
            r#"claims = [1, 5000000000]
length_unit"#
        )),
        r#"study.toml:2:14: claims.1: must be <= 4294967295, is 5000000000
  |
2 | claims = [1, 5000000000]
  |              ^^^^^^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"sensor = { kind = "pads", pitch = 0.1, cap_deg = 180.5 }"#
        )),
        r#"study.toml:9:50: scene.sensor.cap_deg: must be <= 180, is 180.5
  |
9 | sensor = { kind = "pads", pitch = 0.1, cap_deg = 180.5 }
  |                                                  ^^^^^"#
    );
    assert_eq!(
        message(&with(
            r#"noise = { angular_velocity = { kind = "uniform", fraction = -0.01 } }"#
        )),
        r#"study.toml:9:61: scene.noise.angular_velocity.fraction: must be >= 0, is -0.01
  |
9 | noise = { angular_velocity = { kind = "uniform", fraction = -0.01 } }
  |                                                             ^^^^^"#
    );
}

#[test]
fn numbers_that_are_not_finite() {
    assert_eq!(
        message(&edited("5.0", "nan")),
        r#"study.toml:7:38: scene.object.radius: must be finite, is nan
  |
7 | object = { kind = "sphere", radius = nan }
  |                                      ^^^"#
    );
    assert_eq!(
        message(&edited("0.1", "-inf")),
        r#"study.toml:8:29: scene.motion.rate_rad_per_s: must be finite, is -inf
  |
8 | motion = { rate_rad_per_s = -inf, duration_s = 1.0 }
  |                             ^^^^"#
    );
    assert_eq!(
        message(&edited("5.0", "1e999")),
        r#"study.toml:7:38: scene.object.radius: must be finite, is inf
  |
7 | object = { kind = "sphere", radius = 1e999 }
  |                                      ^^^^^"#
    );
}

#[test]
fn arrays_of_a_wrong_length() {
    assert_eq!(
        message(&edited(
            r#"{ kind = "sphere", radius = 5.0 }"#,
            r#"{ kind = "ellipsoid", semi_axes = [1, 2] }"#
        )),
        r#"study.toml:7:44: scene.object.semi_axes: expected 3 items, found 2
  |
7 | object = { kind = "ellipsoid", semi_axes = [1, 2] }
  |                                            ^^^^^^"#
    );
    assert_eq!(
        message(&edited(
            r#"{ kind = "sphere", radius = 5.0 }"#,
            r#"{ kind = "ellipsoid", semi_axes = [1, 2, -3] }"#
        )),
        r#"study.toml:7:51: scene.object.semi_axes.2: must be > 0, is -3
  |
7 | object = { kind = "ellipsoid", semi_axes = [1, 2, -3] }
  |                                                   ^^"#
    );
    assert_eq!(
        message(&edited(
            "duration_s = 1.0",
            "duration_s = 1.0, directions_deg = []"
        )),
        r#"study.toml:8:69: scene.motion.directions_deg: expected at least 1 item, found 0
  |
8 | motion = { rate_rad_per_s = 0.1, duration_s = 1.0, directions_deg = [] }
  |                                                                     ^^"#
    );
}

#[test]
fn names_that_are_no_file_names() {
    assert_eq!(
        message(&edited("a-study", "A study")),
        r#"study.toml:1:8: name: "A study" is not a name: lower-case letters and digits, joined by single hyphens, at most 100
  |
1 | name = "A study"
  |        ^^^^^^^^^"#
    );
    assert_eq!(
        message(&edited("a-study", "../up")),
        r#"study.toml:1:8: name: "../up" is not a name: lower-case letters and digits, joined by single hyphens, at most 100
  |
1 | name = "../up"
  |        ^^^^^^^"#
    );
    assert_eq!(
        message(&edited("a-study", "")),
        r#"study.toml:1:8: name: "" is not a name: lower-case letters and digits, joined by single hyphens, at most 100
  |
1 | name = ""
  |        ^^"#
    );
}

#[test]
fn fields_that_contradict_each_other() {
    assert_eq!(
        message(&edited(
            "duration_s = 1.0",
            "duration_s = 1.0, arc_length = 2"
        )),
        r#"study.toml:8:65: scene.motion.arc_length: cannot stand beside `duration_s`; keep one of them
  |
8 | motion = { rate_rad_per_s = 0.1, duration_s = 1.0, arc_length = 2 }
  |                                                                 ^"#
    );
    assert_eq!(
        message(&edited(", duration_s = 1.0", "")),
        r#"study.toml:8:10: scene.motion: needs `duration_s`, `arc_length` or `angle_deg`
  |
8 | motion = { rate_rad_per_s = 0.1 }
  |          ^^^^^^^^^^^^^^^^^^^^^^^^"#
    );
    assert_eq!(
        message(&edited(
            "duration_s = 1.0",
            r#"duration_s = 1.0, axis = "chart""#
        )),
        r#"study.toml:8:59: scene.motion.axis: "chart" needs a model in the probe's chart: `scene.model` with chart = "montana"
  |
8 | motion = { rate_rad_per_s = 0.1, duration_s = 1.0, axis = "chart" }
  |                                                           ^^^^^^^"#
    );
}
