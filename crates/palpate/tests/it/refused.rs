//! Configs that `palpate run` refuses: one message with the place, status 2, nothing written.

use super::desk::{Desk, SCENE, STUDY, assert_untouched, edited};

/// Error message about a config that must be refused as bad usage.
#[track_caller]
fn said(config: &str) -> String {
    let desk = Desk::with(config);
    let said = desk.palpate("run c.toml").said(2);
    assert_untouched(&desk.path(""));
    said.strip_prefix("error: ").unwrap().to_owned()
}

/// Each config is the scene with one piece replaced; each message begins with a place and a field
/// and holds the words.
#[track_caller]
fn refused(from: &str, to: &str, place_and_field: &str, words: &[&str]) {
    let said = said(&edited(SCENE, from, to));
    assert!(
        said.starts_with(&format!("c.toml:{place_and_field}: ")),
        "{to}: {said}"
    );
    for word in words {
        assert!(said.contains(word), "{word:?} is not in {said}");
    }
    // The line stands in the message, with a caret under the place.
    assert!(
        said.lines()
            .any(|line| line.trim_start_matches([' ', '|']).starts_with('^')),
        "{said}"
    );
}

const OBJECT: &str = r#"{ kind = "sphere", radius = 50.0 }"#;
const LAST: &str = "duration_s = 1.0 }\n";

#[test]
fn keys_and_types() {
    refused(
        "radius = 50.0",
        "radus = 50.0",
        "8:29: scene.object.radus",
        &["unknown key", "did you mean `radius`?"],
    );
    refused(
        "radius = 50.0",
        "radius = \"wide\"",
        "8:38: scene.object.radius",
        &["expected a number, found the string \"wide\""],
    );
    refused("50.0 }", "50.0 ]", "8:43", &["`,`"]);
    assert_eq!(
        said("name = \"a-study\"\n"),
        "c.toml: scene: missing table\n"
    );
    assert!(said("").starts_with("c.toml: the config is empty"));
}

#[test]
fn files() {
    let desk = Desk::with("");
    assert_eq!(
        desk.palpate("run none.toml").said(2),
        "error: none.toml: no such file\n"
    );
    assert_eq!(
        desk.palpate("run .").said(2),
        "error: .: is a directory, not a config\n"
    );
    desk.write("c.toml", b"name = \"\xff\"");
    assert!(desk.palpate("run c.toml").said(2).contains("c.toml: "));
}

#[test]
fn numbers() {
    for (text, shown) in [("0", "0"), ("-5.0", "-5")] {
        refused(
            "50.0",
            text,
            "8:38: scene.object.radius",
            &[&format!("must be > 0, is {shown}")],
        );
    }
    for text in ["nan", "inf", "-inf"] {
        refused(
            "50.0",
            text,
            "8:38: scene.object.radius",
            &[&format!("must be finite, is {text}")],
        );
    }
    refused(
        "trials = 20",
        "trials = 0",
        "3:10: trials",
        &["must be >= 1, is 0"],
    );
    refused(
        LAST,
        &format!("{LAST}model = {{ kind = \"auto\", tolerance = 0 }}\n"),
        "10:38: scene.model.tolerance",
        &["must be > 0, is 0"],
    );
    refused(
        LAST,
        &format!("{LAST}sensor = {{ kind = \"pads\", pitch = 40.0 }}\n"),
        "10:35: scene.sensor.pitch",
        &["at most the probe's radius, 10, is 40"],
    );
}

#[test]
fn sweeps() {
    let empty = said(&edited(STUDY, "[50, 5]", "[]"));
    assert!(
        empty.starts_with("c.toml:15:10: sweep.0.values: "),
        "{empty}"
    );
    let nowhere = said(&edited(STUDY, "scene.object.radius", "scene.object.radus"));
    assert!(
        nowhere.starts_with("c.toml:14:8: scene.object.radus: "),
        "{nowhere}"
    );
    assert!(nowhere.contains("did you mean `radius`?"), "{nowhere}");
    let negative = said(&edited(STUDY, "[50, 5]", "[50, -5]"));
    assert!(
        negative.starts_with("c.toml:15:15: scene.object.radius: must be > 0, is -5"),
        "{negative}"
    );
    assert!(
        negative.contains("in cell 1: scene.object.radius = -5"),
        "{negative}"
    );
}

#[test]
fn formulas() {
    let formula = |text: &str| format!("{{ kind = \"height-field\", formula = \"{text}\" }}");
    refused(
        OBJECT,
        &formula("sin(k*x)"),
        "8:50: scene.object.formula",
        &[
            "unknown name `k`",
            "formula = \"sin(k*x)\" }\n  |                                                  ^\n",
        ],
    );
    refused(
        OBJECT,
        &formula("sin(x)+*2"),
        "8:53: scene.object.formula",
        &[
            "found `*`",
            "formula = \"sin(x)+*2\" }\n  |                                                     ^\n",
        ],
    );
    refused(
        OBJECT,
        &formula("sqrt(x - 1)"),
        "8:45: scene.object.formula",
        &["x = 0, y = 0"],
    );
    refused(OBJECT, &formula(""), "8:45: scene.object.formula", &[]);
}

#[test]
fn contacts() {
    refused(
        OBJECT,
        r#"{ kind = "dish", radius = 5 }"#,
        "8:10: scene.object",
        &["conform", "-0.1"],
    );
    refused(
        OBJECT,
        r#"{ kind = "dish", radius = 10 }"#,
        "8:10: scene.object",
        &["conform"],
    );
    refused(
        LAST,
        &format!("{LAST}object_contact = [60, 0]\n"),
        "10:18: scene.object_contact",
        &["x = 60, y = 0"],
    );
}

#[test]
fn directions() {
    for (directions, words) in [
        ("[]", "expected at least 1 item, found 0"),
        ("[0]", "1 probe(s)"),
        ("[30, 210]", "the 2 probes do not span the tangent plane"),
        ("[30, 30, 30]", "the 3 probes do not span the tangent plane"),
    ] {
        refused(
            "duration_s = 1.0",
            &format!("duration_s = 1.0, directions_deg = {directions}"),
            "9:69: scene.motion.directions_deg",
            &[words],
        );
    }
}

#[test]
fn models() {
    refused(
        &format!("{OBJECT}\n"),
        "{ kind = \"saddle\", a = 0.001 }\nmodel = { kind = \"closed-form\" }\n",
        "9:18: scene.model.kind",
        &["saddle", "closed form"],
    );
}

#[test]
fn maps() {
    refused(
        "length_unit",
        "outputs = [\"map\"]\nlength_unit",
        "2:11: outputs",
        &["a roll has no map"],
    );
}

/// Results of an earlier run stay as they were.
#[test]
fn earlier_results_stay() {
    let desk = Desk::with(SCENE);
    desk.palpate("run c.toml --out o").printed();
    let before = desk.read("o/cells.csv");
    desk.write("c.toml", edited(SCENE, "50.0", "-50.0"));
    for command in ["run", "trace"] {
        desk.palpate(&format!("{command} c.toml --out o")).said(2);
    }
    assert_eq!(desk.names("o").len(), 3);
    assert_eq!(desk.read("o/cells.csv"), before);
}
