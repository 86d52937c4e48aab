//! Fields that a config writes although it sweeps them.

use super::desk::{Desk, STUDY, edited};

#[test]
fn a_written_value_that_a_sweep_replaces_is_told() {
    let desk = Desk::with(&edited(
        STUDY,
        "object = { kind = \"sphere\", radius = 50.0 }",
        "object = { kind = \"sphere\", radius = 0.7 }",
    ));
    let note = "note: line 9: scene.object.radius = 0.7 is swept over by line 14, which sets it to 50, 5\n";
    let ended = desk.palpate("check c.toml");
    assert_eq!((ended.swept.as_str(), ended.stderr.as_str()), (note, ""));
    let ended = desk.palpate("run c.toml --out o");
    assert_eq!((ended.swept.as_str(), ended.stderr.as_str()), (note, ""));
    // The config that a run writes has the first value of each sweep in its place, and says nothing.
    assert_eq!(desk.palpate("run o/run.toml --out p").swept, "");
    // What arguments set is not told.
    let line =
        "distinguish c.toml --vary scene.object.radius=20,30 --quantity mean_curvature --trials 20";
    assert_eq!(desk.palpate(line).swept, "");
    desk.write("c.toml", edited(STUDY, ", radius = 50.0 }", " }"));
    let ended = desk.palpate("check c.toml");
    assert_eq!((ended.status, ended.swept.as_str()), (Some(0), ""));
}

#[test]
fn many_values_are_cut_short_and_tables_not_shown() {
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
    let table = edited(
        STUDY,
        "path = \"scene.object.radius\"\nvalues = [50, 5]",
        "path = \"scene.object\"\nvalues = [{ kind = \"sphere\", radius = 50.0 }]\nlabels = [\"ball\"]",
    );
    let said = Desk::with(&table).palpate("check c.toml").swept;
    assert!(
        said.is_empty() || said.contains("line 9: scene.object is swept over by line 14"),
        "{said}"
    );
}

/// A newcomer changes what stands in an example: none of that is swept.
#[test]
fn the_examples_write_nothing_that_they_sweep() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let mut configs = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            let ended = Desk::new().palpate(&format!("check {}", path.display()));
            assert_eq!(
                (ended.status, ended.swept.as_str()),
                (Some(0), ""),
                "{path:?}"
            );
            configs += 1;
        }
    }
    assert!(configs >= 4);
}
