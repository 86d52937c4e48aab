//! Tests that files of results are written completely or not at all.

use super::desk::{Desk, RUN_FILES, STUDY, edited};

#[test]
fn a_config_edited_by_hand_is_not_overwritten() {
    let desk = Desk::with(STUDY);
    desk.palpate("run c.toml --out o").printed();
    let config = desk.read("o/run.toml");
    std::fs::create_dir(desk.path("mine")).unwrap();
    for noted in ["# more\ntrials = 20", "trials = 20 # enough"] {
        let by_hand = edited(&config, "trials = 20", noted);
        desk.write("mine/run.toml", &by_hand);
        desk.palpate("run c.toml --out mine").fails(
            2,
            "mine/run.toml is not a file that palpate wrote, and would be replaced",
        );
        assert_eq!(desk.read("mine/run.toml"), by_hand);
    }
    // An empty file may be overwritten, because it has no contents that could be lost.
    desk.write("o/next-run.toml", "");
    desk.palpate("run c.toml --out o").printed();
}

/// A `#` within a string is not a comment, even at the start of a line.
#[test]
fn a_hash_in_a_title_does_not_count_as_an_edit() {
    let title = "title = \"\"\"\none\n# two, no. # 3\"\"\"\nlength_unit";
    let desk = Desk::with(&edited(STUDY, "length_unit", title));
    desk.palpate("run c.toml --out o").printed();
    assert!(desk.read("o/run.toml").contains("\n# two"));
    desk.palpate("run o/run.toml --out o").printed();
}

/// Shell command that runs the program with a limit of 512 bytes per file. For the program, the limit has the same
/// effect as a full disk.
const FULL: &str = "ulimit -f 1; trap '' XFSZ; exec \"$palpate\"";

#[test]
fn a_full_disk_keeps_earlier_results_and_no_partly_written_file() {
    let desk = Desk::with(STUDY);
    desk.palpate("run c.toml --out o").printed();
    desk.palpate("trace c.toml --out o").printed();
    let before: Vec<(String, String)> = desk
        .names("o")
        .iter()
        .map(|name| (name.clone(), desk.read(&format!("o/{name}"))))
        .collect();
    assert_eq!(before.len(), 5);
    for command in [
        "run c.toml --out o --seed 99",
        "trace c.toml --out o --trial 3",
    ] {
        let said = desk.shell(&format!("{FULL} {command}")).said(1);
        assert!(said.starts_with("error: cannot write o/"), "{said}");
        assert!(!said.contains(".palpate-"), "{said}");
        let names: Vec<&str> = before.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(desk.names("o"), names);
        for (name, contents) in &before {
            assert_eq!(&desk.read(&format!("o/{name}")), contents, "{name} changed");
        }
    }
    desk.shell(&format!("{FULL} run c.toml --out new")).said(1);
    assert_eq!(desk.names("new"), [""; 0]);
}

/// The disk becomes full after the tables were written but before the last file was written.
#[test]
fn a_disk_that_fills_up_keeps_no_table_of_another_run() {
    let desk = Desk::with(STUDY);
    desk.palpate("run c.toml --out o").printed();
    let before = RUN_FILES.map(|name| desk.read(&format!("o/{name}")));
    let outputs = "outputs = [\"cells\", \"trace\"]\nlength_unit";
    desk.write("c.toml", edited(STUDY, "length_unit", outputs));
    let limit = FULL.replace("ulimit -f 1;", "ulimit -f 16;");
    let said = desk
        .shell(&format!("{limit} run c.toml --out o --seed 99"))
        .said(1);
    assert!(
        said.starts_with("error: cannot write o/trace.csv"),
        "{said}"
    );
    let [cells, failures, config] = RUN_FILES;
    assert_eq!(
        desk.names("o"),
        [cells, failures, "journal.palpate", config]
    );
    assert_eq!(
        RUN_FILES.map(|name| desk.read(&format!("o/{name}"))),
        before
    );
    // When there is space on the disk again, the same command writes the results.
    let ended = desk.palpate("run c.toml --out o --seed 99");
    assert!(
        ended.stderr.contains("note: resumes after 2 of 2 cells"),
        "{}",
        ended.stderr
    );
    assert!(desk.names("o").contains(&"trace.csv".to_owned()));
    assert!(!desk.names("o").contains(&"journal.palpate".to_owned()));
}

/// The reader of a pipe may stop reading early, as `head` does in `palpate schema | head -1`.
#[test]
fn a_closed_pipe_is_no_error() {
    let ended = Desk::new().shell("{ \"$palpate\" schema; echo $? >&2; } | head -c 1");
    assert_eq!((ended.stdout.as_str(), ended.stderr.as_str()), ("{", "0\n"));
}

#[cfg(unix)]
#[test]
fn results_can_be_read_by_others() {
    use std::os::unix::fs::PermissionsExt;
    let desk = Desk::with(STUDY);
    desk.palpate("run c.toml --out o").printed();
    for name in desk.names("o") {
        let mode = std::fs::metadata(desk.path(&format!("o/{name}")))
            .unwrap()
            .permissions()
            .mode();
        assert_eq!(mode & 0o777, 0o644, "{name}");
    }
}
