//! A table of hostile calls: what stands in the directory, the call, its status, words of its message; whatever the user
//! had has the same bytes after it.

use super::desk::{Desk, SCENE, STUDY, edited};

/// A call: a line of the shell in which `$palpate` is the binary and `$E` the examples.
struct Row {
    files: &'static [&'static str],
    line: &'static str,
    status: i32,
    words: &'static str,
}

const fn row(
    files: &'static [&'static str],
    line: &'static str,
    status: i32,
    words: &'static str,
) -> Row {
    Row {
        files,
        line,
        status,
        words,
    }
}

const MINE: &str = "MY DATA\n";
const OURS: &str = "is not a file that palpate wrote";
const READ: &str = "is read by this very command";

/// Commands that write a directory `d`, with the names that each writes.
const INTO_A_DIRECTORY: [(&str, &[&str]); 3] = [
    ("trace c.toml", &["trace.csv", "readings.csv"]),
    (
        "sensor pattern $E/press-with-a-camera.toml",
        &[
            "pattern.svg",
            "pattern.dxf",
            "strain.csv",
            "strain-by-gores.csv",
        ],
    ),
    (
        "run c.toml",
        &["run.toml", "cells.csv", "failures.csv", "warnings.txt"],
    ),
];

/// Commands that write a file `f`, each after the flag that names it.
const INTO_A_FILE: [&str; 3] = [
    "estimate glide $E/glide-readings.csv --map",
    "sensor calibrate $E/chromatouch-2020/calibration-normal.csv --out",
    "report r --out",
];

const ROWS: [Row; 17] = [
    row(&["io.csv"], "estimate glide io.csv --map io.csv", 2, READ),
    row(
        &["c.toml"],
        "trace c.toml --out c.toml",
        1,
        "c.toml is a file",
    ),
    row(
        &["c.toml"],
        "run c.toml --out c.toml",
        1,
        "c.toml is a file",
    ),
    row(&[], "run c.toml --out /dev/null", 1, "/dev/null is a file"),
    row(
        &[],
        "trace c.toml --out /dev/null/d",
        1,
        "/dev/null is a file",
    ),
    row(
        &[],
        "estimate roll /dev/zero --probe-radius 10",
        1,
        "larger than 256 MiB",
    ),
    row(&[], "estimate glide /dev/zero", 1, "larger than 256 MiB"),
    row(
        &[],
        "estimate press /dev/zero --sensor-radius 20",
        1,
        "larger than 256 MiB",
    ),
    row(
        &[],
        "sensor calibrate /dev/zero --out f",
        1,
        "larger than 256 MiB",
    ),
    row(
        &[],
        "sensor track /dev/zero /dev/zero --out d",
        1,
        "larger than 256 MiB",
    ),
    row(&[], "check /dev/zero", 2, "larger than 16 MiB"),
    row(&[], "run /dev/zero --out d", 2, "larger than 16 MiB"),
    row(&[], "trace /dev/zero --out d", 2, "larger than 16 MiB"),
    row(
        &[],
        "sensor pattern /dev/zero --out d",
        2,
        "larger than 16 MiB",
    ),
    row(&[], "check /dev/null", 2, "is empty"),
    row(
        &[],
        "estimate roll /dev/null --probe-radius 10",
        1,
        "is empty",
    ),
    row(&[], "estimate glide .", 1, "is a directory"),
];

/// A desk with a config, a run of it in `r`, and the examples as `$E`.
fn desk() -> Desk {
    Desk::with(STUDY)
}

#[track_caller]
fn call(desk: &Desk, line: &str, status: i32, words: &str) {
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let ended = desk.shell(&format!("E={examples}; exec \"$palpate\" {line}"));
    let said = format!("{line}: {ended:?}");
    assert_eq!(ended.status, Some(status), "{said}");
    assert!(ended.stderr.contains(words), "{words:?} is not in {said}");
    assert!(!ended.stderr.contains("panicked"), "{said}");
}

#[test]
fn rows() {
    for Row {
        files,
        line,
        status,
        words,
    } in ROWS
    {
        let desk = desk();
        for name in files {
            if *name != "c.toml" {
                desk.write(name, MINE);
            }
        }
        call(&desk, line, status, words);
        for name in files {
            let kept = if *name == "c.toml" { STUDY } else { MINE };
            assert_eq!(desk.read(name), kept, "{line}");
        }
    }
}

#[test]
fn files_of_the_user_in_a_directory_stay() {
    for (command, names) in INTO_A_DIRECTORY {
        for name in names {
            let desk = desk();
            std::fs::create_dir(desk.path("d")).unwrap();
            let file = format!("d/{name}");
            desk.write(&file, MINE);
            let is_run = command.starts_with("run");
            let words = if is_run { "palpate" } else { OURS };
            call(&desk, &format!("{command} --out d"), 2, words);
            assert_eq!(desk.read(&file), MINE);
            assert_eq!(desk.names("d"), [*name]);
            // A link to it is no other file.
            std::fs::rename(desk.path(&file), desk.path("mine")).unwrap();
            std::os::unix::fs::symlink("../mine", desk.path(&file)).unwrap();
            call(&desk, &format!("{command} --out d"), 2, words);
            assert_eq!(desk.read("mine"), MINE);
            call(&desk, &format!("{command} --out d --force"), 0, "");
            assert!(desk.path(&file).is_symlink());
        }
    }
}

#[test]
fn what_palpate_wrote_it_may_write_again() {
    for (command, names) in INTO_A_DIRECTORY {
        let desk = desk();
        call(&desk, &format!("{command} --out d"), 0, "");
        call(&desk, &format!("{command} --out d"), 0, "");
        for name in names.iter().filter(|name| **name != "warnings.txt") {
            let (file, known) = (format!("d/{name}"), desk.read(&format!("d/{name}")));
            let edited = format!("{known}mine\n");
            desk.write(&file, &edited);
            call(
                &desk,
                &format!("{command} --out d"),
                2,
                "was changed since palpate wrote it",
            );
            assert_eq!(desk.read(&file), edited);
            call(&desk, &format!("{command} --out d --force"), 0, "");
            assert_eq!(desk.read(&file), known);
        }
    }
}

#[test]
fn single_files_of_the_user_stay() {
    for command in INTO_A_FILE {
        let desk = desk();
        call(&desk, "run c.toml --out r", 0, "");
        desk.write("f", MINE);
        std::os::unix::fs::symlink("f", desk.path("link")).unwrap();
        for name in ["f", "link", "./link"] {
            call(&desk, &format!("{command} {name}"), 2, OURS);
            assert_eq!(desk.read("f"), MINE);
        }
        call(&desk, &format!("{command} ."), 2, "is not a file name");
        call(&desk, &format!("{command} link --force"), 0, "");
        assert!(desk.path("link").is_symlink());
        let written = desk.read("f");
        assert_ne!(written, MINE);
        // Palpate's own, and what lies behind no name of a file.
        call(&desk, &format!("{command} f"), 0, "");
        call(&desk, &format!("{command} /dev/null"), 0, "");
        call(
            &desk,
            &format!("{command} /dev/full"),
            1,
            "cannot write /dev/full",
        );
        for place in ["-", "/dev/stdout"] {
            let line = format!("{command} {place}");
            let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
            let ended = desk.shell(&format!("E={examples}; exec \"$palpate\" {line} 2>said"));
            assert_eq!((ended.status, &ended.stdout), (Some(0), &written), "{line}");
        }
        let pipe = format!("{command} pipe & cat pipe > got; wait $!");
        let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
        let ended = desk.shell(&format!("E={examples}; mkfifo pipe; \"$palpate\" {pipe}"));
        assert_eq!(ended.status, Some(0), "{ended:?}");
        assert_eq!(desk.read("got"), written);
        assert!(!desk.path("-").exists() && !desk.path("pipe").is_file());
    }
}

#[test]
fn inputs_are_not_replaced() {
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let desk = desk();
    for (from, name, line) in [
        (
            "glide-readings.csv",
            "in.csv",
            "estimate glide in.csv --map in.csv",
        ),
        (
            "chromatouch-2020/calibration-normal.csv",
            "in.csv",
            "sensor calibrate in.csv --out ./in.csv",
        ),
    ] {
        let known = std::fs::read(format!("{examples}/{from}")).unwrap();
        desk.write(name, &known);
        call(&desk, line, 2, READ);
        assert_eq!(desk.read(name).as_bytes(), known);
    }
    call(&desk, "run c.toml --out r", 0, "");
    let cells = desk.read("r/cells.csv");
    call(&desk, "report r --out r/cells.csv", 2, READ);
    assert_eq!(desk.read("r/cells.csv"), cells);
}

#[test]
fn a_run_leaves_nothing_of_another_study() {
    let desk = desk();
    call(&desk, "run c.toml --out o", 0, "");
    call(&desk, "trace c.toml --out o", 0, "");
    desk.write("o/notes.md", MINE);
    // The same study again: all stays.
    call(&desk, "run c.toml --out o", 0, "");
    assert!(desk.path("o/trace.csv").exists());
    let edited_by_hand = desk.read("o/readings.csv") + "mine\n";
    desk.write("o/readings.csv", &edited_by_hand);
    call(
        &desk,
        "run c.toml --out o --seed 8",
        0,
        "o/readings.csv is not of this study",
    );
    assert_eq!(
        desk.names("o"),
        [
            "cells.csv",
            "failures.csv",
            "notes.md",
            "readings.csv",
            "run.toml"
        ]
    );
    assert_eq!(desk.read("o/readings.csv"), edited_by_hand);
    assert_eq!(desk.read("o/notes.md"), MINE);
    // Without its manifest the directory is palpate's by the names.
    std::fs::remove_file(desk.path("o/.palpate.toml")).unwrap();
    call(
        &desk,
        "run c.toml --out o",
        0,
        "o/notes.md is not of this study",
    );
    assert_eq!(
        desk.names("o"),
        ["cells.csv", "failures.csv", "notes.md", "run.toml"]
    );
}

#[test]
fn manifests_that_are_not_palpates() {
    let desk = desk();
    call(&desk, "run c.toml --out o", 0, "");
    desk.write("mine", MINE);
    for (text, words) in [
        ("", "is no manifest of palpate"),
        ("\0", "is no manifest of palpate"),
        (
            "version = 2\n",
            "is of version 2; this palpate knows version 1",
        ),
        ("version = 1\nmore = 1\n", "is no manifest of palpate"),
        (
            "version = 1\n[files.\"../mine\"]\nsha256 = []\n",
            "names `../mine`",
        ),
    ] {
        desk.write("o/.palpate.toml", text);
        for line in ["run c.toml --out o", "trace c.toml --out o"] {
            call(&desk, line, 2, words);
        }
    }
    assert_eq!(desk.read("mine"), MINE);
    call(&desk, "run c.toml --out o --force", 0, "");
}

#[test]
fn who_holds_a_directory_is_said() {
    let desk = desk();
    std::fs::create_dir(desk.path("o")).unwrap();
    desk.write("o/.palpate-lock", "4711");
    let held = std::fs::File::open(desk.path("o/.palpate-lock")).unwrap();
    held.lock().unwrap();
    for line in ["run c.toml --out o", "trace c.toml --out o"] {
        call(&desk, line, 1, "o is held by process 4711");
    }
    drop(held);
    desk.write("o/.palpate-a1B2c3", MINE);
    desk.write("o/.palpate-notes.md", MINE);
    call(&desk, "run c.toml --out o", 0, "");
    assert_eq!(
        desk.names("o"),
        [".palpate-notes.md", "cells.csv", "failures.csv", "run.toml"]
    );
}

#[test]
fn a_run_in_which_all_fails_says_so() {
    let pads = "sensor = { kind = \"pads\", pitch = 1, cap_deg = 15 }\nnoise";
    let desk = Desk::with(&edited(&edited(STUDY, "noise", pads), "[50, 5]", "[50]"));
    call(&desk, "run c.toml --out o", 1, "every trial failed");
    assert_eq!(desk.names("o"), ["cells.csv", "failures.csv", "run.toml"]);
    let far = Desk::with(&edited(SCENE, "duration_s = 1.0", "duration_s = 70.0"));
    call(
        &far,
        "run c.toml --out o",
        1,
        "warning: the contact passes half way",
    );
    assert!(far.read("o/warnings.txt").contains("half way"));
}

#[test]
fn quotation_marks_are_closed() {
    let desk = Desk::new();
    let header = "probe,rotation_x_rad,rotation_y_rad,shift_u_mm,shift_v_mm\n";
    for row in ["\"0,0,-0.5,3.75,0", "0\",0,-0.5,3.75,0", "0,\",-0.5,3.75,0"] {
        desk.write("r.csv", format!("{header}0,0,-0.5,3.75,0\n{row}\n"));
        call(
            &desk,
            "estimate roll r.csv --probe-radius 10",
            1,
            "r.csv:3: a quotation mark is not closed",
        );
    }
}
