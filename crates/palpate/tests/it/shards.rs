//! Tests shards of a study, and the command that merges them.

use std::fs;

use super::desk::{Desk, RUN_FILES, STUDY, assert_close, edited};

/// A study of rolls with seven cells. It writes no `map.csv`. Some cells fail, and `check` warns about some cells.
pub(crate) fn many() -> String {
    let study = edited(
        STUDY,
        "values = [50, 5]",
        "values = [50, 40, 30, 20, 10, 5, 2]",
    );
    edited(&study, "duration_s = 1.0", "duration_s = 2.0")
}

/// A study of presses with maps. Its tables contain a lower bound on the standard deviation, and some cells have
/// warnings.
pub(crate) const PRESSES: &str = r#"name = "presses"
length_unit = "mm"
trials = 10
outputs = ["cells", "map", "trace"]

[scene]
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, layout = "published" }
object = { kind = "sphere", radius = 30.0 }
motion = { indentation = 1.0 }
model = { kind = "half-space" }
sensor = { kind = "direct", tangential = false }
noise = { normal_displacement = { kind = "gaussian", std = 0.05 } }
estimator = { kind = "half-space", indentation = "fitted" }

[[sweep]]
path = "scene.motion.indentation"
values = [0.5, 1.0, 3.0, 7.0, 9.0]
"#;

fn shards(desk: &Desk, of: usize) {
    for number in (1..=of).rev() {
        let line = format!("run c.toml --shard {number}/{of} --out s/{number}");
        let ended = desk.palpate(&line);
        let words = format!("shard {number} of {of}, ");
        let is_printed = ended.stdout.contains(&words);
        assert!(ended.status == Some(0) && is_printed, "{ended:?}");
        assert_eq!(
            desk.names(&format!("s/{number}")),
            ["journal.palpate", "run.toml"]
        );
    }
}

fn refused(desk: &Desk, line: &str, words: &[&str]) {
    let said = desk.palpate(line).said(1);
    for words in words {
        assert!(said.contains(words), "{said}");
    }
    assert_eq!(desk.names("m"), [""; 0], "{line}");
}

#[test]
fn merged_shards_equal_one_run() {
    for (config, of) in [
        (many(), 1),
        (many(), 3),
        // With 9 shards for 7 cells, some shards have no cells.
        (many(), 9),
        (PRESSES.to_owned(), 3),
    ] {
        let desk = Desk::with(&config);
        desk.palpate("run c.toml --out whole");
        shards(&desk, of);
        // The second merge overwrites the files of the first merge.
        for line in ["merge s --out m", "merge s/ --out m"] {
            let ended = desk.palpate(line);
            assert_eq!(ended.status, Some(0), "{ended:?}");
        }
        let names = desk.names("whole");
        assert_eq!(desk.names("m"), names);
        assert!(names.len() >= RUN_FILES.len());
        for name in &names {
            let [whole, merged] =
                ["whole", "m"].map(|dir| fs::read(desk.path(&format!("{dir}/{name}"))).unwrap());
            assert!(whole == merged, "{name} of {of} shards");
        }
    }
}

#[test]
fn shards_of_every_nth_cell_merge() {
    let desk = Desk::with(&many());
    desk.palpate("run c.toml --every-nth-cell 3 --out whole")
        .printed();
    for number in [1, 2] {
        let line = format!("run c.toml --every-nth-cell 3 --shard {number}/2 --out s/{number}");
        desk.palpate(&line).printed();
    }
    desk.palpate("merge s/1 s/2 --out m").printed();
    for name in RUN_FILES {
        assert_eq!(
            desk.read(&format!("m/{name}")),
            desk.read(&format!("whole/{name}"))
        );
    }
}

#[test]
fn missing_and_repeated_shards_are_named() {
    let desk = Desk::with(&many());
    shards(&desk, 5);
    fs::rename(desk.path("s/3"), desk.path("away")).unwrap();
    refused(&desk, "merge s --out m", &["shard 3 of 5 is missing"]);
    fs::rename(desk.path("s/5"), desk.path("away/5")).unwrap();
    refused(&desk, "merge s --out m", &["shards 3, 5 of 5 are missing"]);
    fs::rename(desk.path("away/5"), desk.path("s/5")).unwrap();
    fs::rename(desk.path("away"), desk.path("s/3")).unwrap();
    // The same shard now exists twice.
    fs::create_dir(desk.path("s/again")).unwrap();
    fs::copy(
        desk.path("s/3/journal.palpate"),
        desk.path("s/again/journal.palpate"),
    )
    .unwrap();
    refused(
        &desk,
        "merge s --out m",
        &["shard 3 of 5 is in s/3 and in s/again"],
    );
    fs::remove_dir_all(desk.path("s/again")).unwrap();
    desk.palpate("merge s --out m").printed();
    assert!(
        desk.palpate("merge m --out n")
            .said(1)
            .contains("no shards in m")
    );
}

#[test]
fn shards_of_another_run_are_named() {
    let desk = Desk::with(&many());
    shards(&desk, 2);
    let of_other = |arguments: &str, words: &[&str]| {
        fs::remove_dir_all(desk.path("s/2")).unwrap();
        desk.palpate(&format!("run {arguments} --out s/2"))
            .printed();
        refused(&desk, "merge s --out m", words);
    };
    of_other(
        "c.toml --seed 9 --shard 2/2",
        &[
            "s/2 belongs to another config than s/1",
            "- seed = 7",
            "+ seed = 9",
        ],
    );
    of_other(
        "c.toml --trials 21 --shard 2/2",
        &["s/2 belongs to another config", "+ trials = 21"],
    );
    of_other(
        "c.toml --every-nth-cell 2 --shard 2/2",
        &["s/2 has another --every-nth-cell"],
    );
    of_other(
        "c.toml --shard 3/3",
        &["s/2 belongs to a run of 3 shards, but s/1 belongs to a run of 2"],
    );
}

#[test]
fn damaged_shards_are_named_and_computed_again() {
    let desk = Desk::with(&many());
    desk.palpate("run c.toml --out whole").printed();
    shards(&desk, 2);
    let place = desk.path("s/2/journal.palpate");
    let sound = fs::read(&place).unwrap();
    for cut in [sound.len() - 1, sound.len() - 9, sound.len() * 2 / 3] {
        fs::write(&place, &sound[..cut]).unwrap();
        desk.palpate("merge s --out m").fails(1, "shard 2 of 2");
        desk.palpate("run c.toml --shard 2/2 --out s/2");
        desk.palpate("merge s --out m").printed();
        assert_eq!(desk.read("m/cells.csv"), desk.read("whole/cells.csv"));
        fs::remove_dir_all(desk.path("m")).unwrap();
    }
    // If the first record is damaged, the rest of the journal cannot be used. Only `--restart` deletes the journal.
    let mut headless = sound.clone();
    headless[100] ^= 8;
    fs::write(&place, &headless).unwrap();
    for line in [
        "merge s --out m",
        "status s/2",
        "run c.toml --shard 2/2 --out s/2",
        "run c.toml --out s/2 --seed 3",
    ] {
        desk.palpate(line)
            .fails(1, "s/2/journal.palpate is damaged at its beginning");
        assert!(fs::read(&place).unwrap() == headless);
    }
    desk.palpate("run c.toml --shard 2/2 --out s/2 --restart");
    for (place_of_bit, bit) in [(sound.len() - 2, 1), (sound.len() * 2 / 3, 64)] {
        let mut damaged = sound.clone();
        damaged[place_of_bit] ^= bit;
        fs::write(&place, &damaged).unwrap();
        desk.palpate("merge s --out m").fails(1, "shard 2 of 2");
        let ended = desk.palpate("run c.toml --shard 2/2 --out s/2");
        assert_eq!(ended.status, Some(0), "{ended:?}");
        desk.palpate("merge s --out m").printed();
        assert_eq!(desk.read("m/cells.csv"), desk.read("whole/cells.csv"));
        fs::remove_dir_all(desk.path("m")).unwrap();
    }
}

#[test]
fn status_counts_shards() {
    let desk = Desk::with(&many());
    desk.palpate("status s").fails(2, "s is no directory");
    shards(&desk, 4);
    desk.palpate("status s").prints_all(&[
        "study    a-study, 4 shards",
        "done     4: shards 1, 2, 3, 4",
        "cells    7 of 7",
        "trials   140, ",
    ]);
    fs::remove_dir_all(desk.path("s/2")).unwrap();
    let place = desk.path("s/4/journal.palpate");
    let sound = fs::read(&place).unwrap();
    fs::write(&place, &sound[..sound.len() - 1]).unwrap();
    desk.palpate("status s").prints_all(&[
        "done     2: shards 1, 3",
        "failed   1: shards 4",
        "missing  1: shards 2",
    ]);
    // A shard that cannot be read and a shard that exists twice are listed after the numbers of cells and trials.
    fs::write(&place, &sound[..60]).unwrap();
    fs::create_dir(desk.path("s/again")).unwrap();
    fs::copy(
        desk.path("s/3/journal.palpate"),
        desk.path("s/again/journal.palpate"),
    )
    .unwrap();
    desk.palpate("status s").prints_all(&[
        "done     2: shards 1, 3",
        "missing  2: shards 2, 4",
        "s/4/journal.palpate is damaged at its beginning",
        "shard 3 of 4 is in s/3 and in s/again",
        "cells    4 of 7",
    ]);
    // If all shards except the damaged one are deleted, the command prints only the message about the damage.
    for number in ["1", "3", "again"] {
        fs::remove_dir_all(desk.path(&format!("s/{number}"))).unwrap();
    }
    desk.palpate("status s")
        .fails(1, "is damaged at its beginning");
}

#[test]
fn status_counts_cells_and_trials() {
    let desk = Desk::with(&many());
    let ended = desk.palpate("run c.toml --out whole");
    let status = desk.palpate("status whole").printed();
    // The run printed the same counts as `palpate status`.
    let counts = ended.stdout.strip_prefix("a-study: 7 cells, 140 trials, ");
    let failed = counts.and_then(|counts| counts.strip_suffix(" -> whole\n"));
    let failed = failed.unwrap_or_else(|| panic!("{ended:?}"));
    assert_eq!(
        status,
        format!("study    a-study\nstate    done\ncells    7\ntrials   140, {failed}\n")
    );
    desk.write(
        "whole/failures.csv",
        "cell,kind,count,first_trial\n0,rank,many,0\n",
    );
    desk.palpate("status whole").fails(
        1,
        "cannot read whole/failures.csv: `many` is not a number of trials",
    );
}

#[test]
fn a_dry_run_prints_slurm_scripts_and_writes_nothing() {
    let desk = Desk::with(STUDY);
    let line = "submit slurm c.toml --shards 16 --time 2:00:00 --partition short --cpus-per-task 4 --dry-run";
    let said = desk.palpate(line).printed();
    for words in [
        "#SBATCH --array=1-16\n",
        "#SBATCH --time=2:00:00\n",
        "#SBATCH --partition=short\n",
        "#SBATCH --cpus-per-task=4\n",
        "#SBATCH --requeue\n",
        "--shard \"$shard/16\"",
        "scontrol requeue \"${SLURM_ARRAY_JOB_ID}_$shard\"",
        " merge ",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert_eq!(desk.names(""), ["c.toml"]);
    // Check that the shell can parse both scripts.
    let parts: Vec<&str> = said.split("#!/bin/bash\n").collect();
    assert_eq!(parts.len(), 3);
    for script in &parts[1..] {
        desk.write("script", script);
        assert_eq!(desk.shell("bash -n script").status, Some(0), "{script}");
    }
    let line = "PATH=/nowhere \"$palpate\" submit slurm c.toml --shards 4 --out o";
    desk.shell(line)
        .fails(1, "there is no `sbatch` on the PATH");
}

#[test]
fn errors_can_be_printed_as_json() {
    let desk = Desk::with(&edited(STUDY, "radius = 10.0", "radius = -1.0"));
    let json_error = |line: &str, status: i32| {
        let ended = desk.palpate(line);
        assert_eq!((ended.status, ended.stdout.as_str()), (Some(status), ""));
        let said = ended.stderr;
        let value: serde_json::Value =
            serde_json::from_str(&said).unwrap_or_else(|_| panic!("{said}"));
        assert_eq!(said.trim_end().lines().count(), 1);
        assert_eq!(
            (&value["error"]["version"], &value["error"]["status"]),
            (&1.into(), &status.into())
        );
        value["error"].clone()
    };
    let error = json_error("run c.toml --error-format json", 2);
    assert_eq!(error["kind"], "usage");
    assert_eq!(
        (&error["file"], &error["line"]),
        (&"c.toml".into(), &8.into())
    );
    assert_eq!(error["field"], "scene.probe.radius");
    assert!(
        error["message"]
            .as_str()
            .unwrap()
            .contains("must be > 0, is -1")
    );
    assert_eq!(json_error("--error-format=json merge .", 1)["kind"], "work");
    let error = json_error("run --error-format json c.toml --threads x", 2);
    assert!(
        error["message"]
            .as_str()
            .unwrap()
            .contains("invalid value 'x'")
    );
    assert!(
        desk.palpate("run c.toml")
            .said(2)
            .starts_with("error: c.toml:8:")
    );
}

#[test]
fn the_stop_rule_ends_each_cell_at_its_standard_error() {
    let rule = "stop = { relative_standard_error = 0.01, max_trials = 20000 }\nseed = 7\n";
    let ruled = edited(STUDY, "seed = 7\ntrials = 20\n", rule);
    let desk = Desk::with(&ruled);
    desk.palpate("run c.toml --out o").printed();
    let table = desk.table("o/cells.csv");
    let trials: Vec<f64> = (0..table.rows.len())
        .map(|row| table.number(row, "trials"))
        .collect();
    assert!(
        trials
            .iter()
            .all(|trials| [2048.0, 4096.0, 8192.0, 16384.0, 20000.0].contains(trials)),
        "{trials:?}"
    );
    for number in [1, 2] {
        desk.palpate(&format!("run c.toml --shard {number}/2 --out s/{number}"))
            .printed();
    }
    desk.palpate("merge s --out m").printed();
    assert_eq!(desk.read("m/cells.csv"), desk.read("o/cells.csv"));
    for (arguments, words) in [
        (
            "--trials 30",
            "--trials sets the number of trials, but `stop` in c.toml also decides it",
        ),
        ("--budget 9s", "--budget sets the number"),
    ] {
        desk.palpate(&format!("run c.toml {arguments}"))
            .fails(2, words);
    }
    desk.write(
        "c.toml",
        edited(&ruled, "max_trials", "quantity = \"depth\", max_trials"),
    );
    let said = desk.palpate("run c.toml").said(2);
    assert!(
        said.contains("stop.quantity: a roll has no quantity \"depth\" (known: "),
        "{said}"
    );
}

#[test]
fn trials_out_has_one_row_per_trial_and_quantity() {
    let noisy = edited(&many(), "duration_s = 2.0", "duration_s = 0.02");
    let pads = "sensor = { kind = \"pads\", pitch = 0.5, layout = \"uniform\", offset = \"random\" }\nnoise";
    let desk = Desk::with(&edited(&noisy, "noise", pads));
    desk.palpate("run c.toml --out o --trials-out t.csv");
    let cells = desk.table("o/cells.csv");
    let trials = desk.table("t.csv");
    let columns = "cell,trial,quantity,unit,estimate,truth,std,failure";
    assert_eq!(trials.header.join(","), columns);
    let mut failed = 0;
    for row in 0..cells.rows.len() {
        let [cell, quantity] =
            ["cell", "quantity"].map(|column| cells.text(row, column).to_owned());
        let is_of_row = |at: &usize| {
            trials.text(*at, "cell") == cell && trials.text(*at, "quantity") == quantity
        };
        let of_row = (0..trials.rows.len()).filter(is_of_row);
        let estimates: Vec<f64> = of_row.map(|at| trials.number(at, "estimate")).collect();
        let failures = cells.number(row, "failures") as usize;
        failed += failures;
        assert_eq!(estimates.len() + failures, 20);
        if failures < 20 {
            let mean = estimates.iter().sum::<f64>() / estimates.len() as f64;
            assert_close(mean, cells.number(row, "mean"), 1e-12);
        }
    }
    assert!(failed > 0, "no trial fails");
    let kinds = desk.table("o/failures.csv");
    let failed_rows = trials.rows.iter().filter(|row| !row[7].is_empty()).count();
    let counts = (0..kinds.rows.len()).map(|row| kinds.number(row, "count"));
    assert_eq!(failed_rows as f64, counts.sum::<f64>());
    // The bytes are the same for any number of threads or shards, and in a file or on standard output.
    let whole = desk.read("t.csv");
    desk.palpate("run c.toml --out p --threads 3 --trials-out u.csv");
    assert!(desk.read("u.csv") == whole);
    for number in [3, 1, 2] {
        let line = format!("run c.toml --shard {number}/3 --out s/{number} --trials-out no.csv");
        desk.palpate(&line);
    }
    assert!(!desk.path("no.csv").exists());
    let ended = desk.palpate("merge s --out m --trials-out -");
    assert!(ended.stdout.starts_with(&whole), "{ended:?}");
    desk.palpate("run c.toml --shard 1/2 --out n/1");
    desk.palpate("run c.toml --shard 2/2 --out n/2");
    desk.palpate("merge n --out q --trials-out v.csv")
        .fails(2, "without --trials-out");
    // The table of trials must not overwrite another file of the run.
    for line in [
        "run c.toml --out o --trials-out o/cells.csv",
        "run c.toml --out fresh --trials-out ./fresh/run.toml",
        "merge s --out m --trials-out m/failures.csv",
    ] {
        desk.palpate(line)
            .fails(2, "the run writes another file of that name");
    }
    assert!(!desk.path("fresh").exists());
    // The user's files are not overwritten.
    desk.write("mine.csv", "a,b\n1,2\n");
    let ended = desk.palpate("run c.toml --out o --trials-out mine.csv");
    assert_eq!(ended.status, Some(2));
    assert_eq!(desk.read("mine.csv"), "a,b\n1,2\n");
}
