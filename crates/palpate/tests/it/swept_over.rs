//! Tests the notes about fields to which a config gives both a value and a sweep.

use super::desk::{Desk, STUDY, edited};

#[test]
fn a_note_names_a_value_that_a_sweep_replaces() {
    let desk = Desk::with(&edited(
        STUDY,
        "object = { kind = \"sphere\", radius = 50.0 }",
        "object = { kind = \"sphere\", radius = 0.7 }",
    ));
    let note =
        "note: line 9: scene.object.radius = 0.7 is replaced by line 14, which sets it to 50, 5\n";
    let ended = desk.palpate("check c.toml");
    assert_eq!((ended.swept.as_str(), ended.stderr.as_str()), (note, ""));
    let ended = desk.palpate("run c.toml --out o");
    assert_eq!((ended.swept.as_str(), ended.stderr.as_str()), (note, ""));
    // A run writes a config that contains the first swept value in each swept field. For such a config, the command
    // prints no note that a sweep replaces the value.
    assert_eq!(desk.palpate("run o/run.toml --out p").swept, "");
    // If a command-line argument varies the field, the command prints no note that the sweep replaces the value.
    let line =
        "distinguish c.toml --vary scene.object.radius=20,30 --quantity mean_curvature --trials 20";
    assert_eq!(desk.palpate(line).swept, "");
    desk.write("c.toml", edited(STUDY, ", radius = 50.0 }", " }"));
    let ended = desk.palpate("check c.toml");
    assert_eq!((ended.status, ended.swept.as_str()), (Some(0), ""));
}

#[test]
fn notes_abbreviate_long_lists() {
    let many = edited(
        STUDY,
        "values = [50, 5]",
        "values = [50, 5, 6, 7, 8, 9, 10, 11, 12, 13]",
    );
    let said = Desk::with(&many).palpate("check c.toml").swept;
    assert!(
        said.ends_with("which sets it to 50, 5, 6, 7, 8, 9, 10, 11, …\n"),
        "{said}"
    );
}

/// Users edit values in the examples. A value that a sweep replaces would have no effect, so no example may contain
/// such a value.
#[test]
fn the_examples_do_not_set_fields_that_they_sweep() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let paths = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut configs = 0;
    for path in paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml")) {
        let notes = palpate_study::config::load(&path).unwrap().swept_over();
        assert!(notes.is_empty(), "{path:?}: {notes:?}");
        configs += 1;
    }
    assert!(configs >= 4);
}
