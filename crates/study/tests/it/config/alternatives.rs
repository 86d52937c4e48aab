//! Tests the three alternative fields for the length of a roll. A config states only one of them.

use palpate_study::config::{SceneConfig, parse, to_toml, with_fields};
use serde_json::json;

use super::{BASE, edited, error, study};

/// The values of the three fields in a cell of the study: `duration_s`, `arc_length` and `angle_deg`. `None` for a
/// field that the config does not state.
fn lengths(text: &str, cell: usize) -> [Option<f64>; 3] {
    let study = parse("study.toml", text).unwrap_or_else(|error| panic!("{error}"));
    let SceneConfig::Roll(roll) = study.cell(cell).unwrap().config.scene else {
        panic!("no roll")
    };
    let motion = roll.motion;
    [motion.duration_s, motion.arc_length, motion.angle_deg]
}

#[test]
fn a_sweep_replaces_an_alternative_field() {
    let swept = format!("{BASE}[[sweep]]\npath = \"scene.motion.angle_deg\"\nvalues = [5, 10]\n");
    assert_eq!(lengths(&swept, 1), [None, None, Some(10.0)]);
    let study = parse("study.toml", &swept).unwrap();
    let notes = study.swept_over();
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert_eq!(
        notes[0].1,
        "line 8: scene.motion.duration_s = 1 is replaced by line 10, which sets scene.motion.angle_deg to 5, 10"
    );
}

#[test]
fn a_varied_field_replaces_a_swept_alternative() {
    let study = study("[[sweep]]\npath = \"scene.motion.duration_s\"\nvalues = [1, 2, 3]\n");
    let varied = [(
        "scene.motion.arc_length".to_owned(),
        vec![0.5.into(), 0.6.into()],
    )];
    let study = study.varied(&varied).unwrap();
    assert_eq!(study.columns, ["scene.motion.arc_length_cm"]);
    assert_eq!(study.cell_count(), 2);
    let both = [
        ("scene.motion.arc_length".to_owned(), vec![0.5.into()]),
        ("scene.motion.angle_deg".to_owned(), vec![5.0.into()]),
    ];
    let path = study.varied(&both).unwrap_err().path;
    assert_eq!(path, "scene.motion.angle_deg");
}

#[test]
fn a_set_field_replaces_a_written_alternative() {
    let field = |path: &str| (path.to_owned(), json!(4.0));
    let angle = field("scene.motion.angle_deg");
    let text = with_fields("study.toml", BASE, std::slice::from_ref(&angle)).unwrap();
    assert_eq!(lengths(&text, 0), [None, None, Some(4.0)]);
    let both = [angle, field("scene.motion.arc_length")];
    let text = with_fields("study.toml", BASE, &both).unwrap();
    assert_eq!(error(&text).path, "scene.motion.arc_length");
}

#[test]
fn a_number_of_rolls_stands_for_their_directions() {
    let directions = |motion: &str| {
        let text = edited("duration_s = 1.0", &format!("duration_s = 1.0, {motion}"));
        let study = parse("study.toml", &text).unwrap();
        // The saved config contains only one of the alternative fields, so it can be parsed again.
        let saved = parse("run.toml", &to_toml(&study.config)).unwrap();
        assert_eq!(saved.config, study.config);
        let SceneConfig::Roll(roll) = study.config.scene else {
            panic!("no roll")
        };
        roll.motion.directions()
    };
    assert_eq!(directions("rolls = 4"), [0.0, 90.0, 180.0, 270.0]);
    assert_eq!(directions("rolls = 3"), [0.0, 120.0, 240.0]);
    assert_eq!(directions("rolls = 2"), [0.0, 90.0]);
    assert_eq!(directions("directions_deg = [5]"), [5.0]);
    let both = edited(
        "duration_s",
        "rolls = 4, directions_deg = [0, 90], duration_s",
    );
    assert_eq!(error(&both).path, "scene.motion.directions_deg");
    let swept = study("[[sweep]]\npath = \"scene.motion.rolls\"\nvalues = [3, 9]\n");
    let SceneConfig::Roll(roll) = swept.cell(1).unwrap().config.scene else {
        panic!("no roll")
    };
    assert_eq!(roll.motion.directions().len(), 9);
    let saved = parse("run.toml", &to_toml(&swept.config)).unwrap();
    assert!(saved.cells().eq(swept.cells()));
}
