//! Results are written whole or not at all.

use super::desk::{Desk, RUN_FILES, STUDY, edited};

#[test]
fn a_directory_under_a_file_cannot_be_made() {
    let desk = Desk::with(STUDY);
    for command in ["run", "trace"] {
        let said = desk
            .palpate(&format!("{command} c.toml --out c.toml/o"))
            .said(1);
        assert!(
            said.contains("cannot make the directory c.toml/o"),
            "{said}"
        );
        assert_eq!(desk.names(""), ["c.toml"]);
        assert_eq!(desk.read("c.toml"), STUDY);
    }
}

#[test]
fn the_directory_is_a_file() {
    let desk = Desk::with(STUDY);
    desk.write("o", "mine");
    let said = desk.palpate("run c.toml --out o").said(1);
    assert!(said.contains("cannot make the directory o"), "{said}");
    assert_eq!(desk.read("o"), "mine");
}

/// Where a name is taken by a directory, the files cannot all be renamed.
#[test]
fn a_name_is_taken_by_a_directory() {
    let desk = Desk::with(STUDY);
    std::fs::create_dir_all(desk.path("o/cells.csv")).unwrap();
    let said = desk.palpate("run c.toml --out o").said(1);
    assert!(said.contains("cannot write o/cells.csv"), "{said}");
    assert_eq!(desk.names("o"), ["cells.csv"]);
}

/// A file may grow to 512 bytes only, which stands for a full disk.
const FULL: &str = "ulimit -f 1; trap '' XFSZ; exec \"$palpate\"";

#[test]
fn a_full_disk_leaves_what_was_there() {
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
}

/// The disk is full only when the tables are written and the last file is not.
#[test]
fn a_disk_that_fills_up_leaves_no_table_of_another_run() {
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
    assert_eq!(desk.names("o"), RUN_FILES);
    assert_eq!(
        RUN_FILES.map(|name| desk.read(&format!("o/{name}"))),
        before
    );
}

#[test]
fn a_full_disk_leaves_nothing_half_written() {
    let desk = Desk::with(STUDY);
    desk.shell(&format!("{FULL} run c.toml --out new")).said(1);
    assert_eq!(desk.names("new"), [""; 0]);
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_is_full() {
    let said = Desk::new()
        .shell("exec \"$palpate\" schema >/dev/full")
        .said(1);
    assert!(said.contains("cannot write to standard output"), "{said}");
}

/// As in `palpate schema | head -1`.
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
