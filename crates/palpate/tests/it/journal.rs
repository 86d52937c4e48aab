//! Tests runs that are killed and resumed later.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::desk::{Desk, RUN_FILES, STUDY, edited};

/// A study with a long run time, which is proportional to `times`. With `times` = 1, a run takes a few seconds on one
/// thread in a build without optimisation.
fn slow_study(times: u32) -> String {
    let values: Vec<String> = (10..34).map(|radius| radius.to_string()).collect();
    let study = edited(STUDY, "[50, 5]", &format!("[{}]", values.join(", ")));
    edited(
        &study,
        "trials = 20",
        &format!("trials = {}", 12_000 * times),
    )
}

pub(crate) fn start_run(desk: &Desk, arguments: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_palpate"))
        .args(arguments.split_whitespace())
        .current_dir(desk.path("."))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Starts a run that writes into `o`, and stops it when its journal exceeds `bytes`. If the run ends earlier, tries
/// again with a study that is four times as long. The function `arguments` makes the command's arguments from the
/// length of the study (`times` of [`slow_study`]).
fn interrupt_run(
    bytes: u64,
    arguments: impl Fn(u32) -> String,
    stop: impl Fn(&Desk, &mut Child),
) -> (Desk, Child, String) {
    for times in [4, 16, 64, 256] {
        let desk = Desk::with(&slow_study(times));
        let arguments = arguments(times);
        let mut child = start_run(&desk, &arguments);
        if wait_for_journal(&desk, &mut child, bytes) && pause(&desk, &mut child) {
            stop(&desk, &mut child);
            if child.wait().unwrap().code() != Some(0) {
                return (desk, child, arguments);
            }
        }
    }
    panic!("every run ended before it was stopped");
}

/// Pauses a run. Returns false if the run has already ended or removed its journal.
fn pause(desk: &Desk, child: &mut Child) -> bool {
    desk.shell(&format!("kill -STOP {}", child.id()));
    child.try_wait().unwrap().is_none() && desk.path("o/journal.palpate").exists()
}

fn kill_run(bytes: u64, arguments: impl Fn(u32) -> String) -> (Desk, String) {
    let (desk, _, arguments) = interrupt_run(bytes, arguments, |_, child| child.kill().unwrap());
    (desk, arguments)
}

/// Whether the journal in `o` became longer than `bytes` before the run ended.
fn wait_for_journal(desk: &Desk, child: &mut Child, bytes: u64) -> bool {
    let start = Instant::now();
    let journal = desk.path("o/journal.palpate");
    while fs::metadata(&journal).map_or(0, |found| found.len()) <= bytes {
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(2));
    }
    true
}

fn assert_same_results(desk: &Desk, one: &str, other: &str) {
    for name in RUN_FILES {
        assert_eq!(
            desk.read(&format!("{one}/{name}")),
            desk.read(&format!("{other}/{name}")),
            "{name}"
        );
    }
    assert_eq!(desk.names(one), desk.names(other));
}

fn on_one_thread(_: u32) -> String {
    "run c.toml --out o --threads 1".to_owned()
}

#[test]
fn a_killed_run_resumes_to_the_same_bytes() {
    let desk = Desk::with(&slow_study(1));
    desk.palpate("run c.toml --out whole").printed();
    for wait in [1, 100, 300, 600] {
        let mut child = start_run(&desk, &on_one_thread(1));
        std::thread::sleep(Duration::from_millis(wait));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert_eq!(desk.palpate("run c.toml --out o").status, Some(0));
    assert_same_results(&desk, "o", "whole");
}

#[test]
fn damaged_records_of_a_journal_are_computed_again() {
    let (desk, _) = kill_run(25_000, on_one_thread);
    desk.palpate("run c.toml --out whole").printed();
    let torn = fs::read(desk.path("o/journal.palpate")).unwrap();
    let config = desk.read("o/run.toml");
    let again = |journal: &[u8]| {
        fs::remove_dir_all(desk.path("o")).unwrap();
        fs::create_dir(desk.path("o")).unwrap();
        desk.write("o/run.toml", &config);
        desk.write("o/journal.palpate", journal);
        let ended = desk.palpate("run c.toml --out o");
        assert_eq!(ended.status, Some(0), "{ended:?}");
        assert_same_results(&desk, "o", "whole");
        ended.stderr
    };
    again(&torn);
    again(&torn[..torn.len() * 2 / 3]);
    // The journal is damaged in two ways: by zeros, which some file systems write at a power failure, and by a flipped
    // bit.
    let mut zeros = torn.clone();
    zeros.extend([0; 5000]);
    assert!(again(&zeros).contains("is damaged; its cells run again"));
    let mut fallen = torn.clone();
    let place = fallen.len() - 20;
    fallen[place] ^= 4;
    assert!(again(&fallen).contains("is damaged; its cells run again"));
}

#[test]
fn a_run_stopped_by_a_signal_resumes() {
    for (signal, status) in [("INT", 130), ("TERM", 143)] {
        let (desk, child, _) = interrupt_run(2_000, on_one_thread, |desk, child| {
            desk.palpate("status o").prints("state    running");
            desk.shell(&format!(
                "kill -{signal} {id}; kill -CONT {id}",
                id = child.id()
            ));
        });
        let ended = child.wait_with_output().unwrap();
        assert_eq!(ended.status.code(), Some(status));
        let said = String::from_utf8(ended.stderr).unwrap();
        assert!(said.contains("error: stopped: "), "{said}");
        assert!(
            said.contains("are in o/journal.palpate; the same command resumes the run"),
            "{said}"
        );
        desk.palpate("status o").prints("state    stopped");
        desk.palpate("run c.toml --out whole").printed();
        let ended = desk.palpate("run c.toml --out o");
        assert!(
            ended.stderr.contains("note: resumes after "),
            "{}",
            ended.stderr
        );
        assert_same_results(&desk, "o", "whole");
    }
}

#[test]
fn another_run_is_refused_and_the_journal_is_kept() {
    let (desk, ..) = interrupt_run(3_000, on_one_thread, |desk, child| {
        desk.palpate("run c.toml --out o --seed 8")
            .fails(1, "o is locked by process");
        child.kill().unwrap();
    });
    let trials = desk.read("c.toml");
    let trials = trials
        .lines()
        .find(|line| line.starts_with("trials = "))
        .unwrap();
    let journal = fs::read(desk.path("o/journal.palpate")).unwrap();
    for (arguments, words) in [
        ("--seed 8", "of another config:\n  - seed = 7\n  + seed = 8"),
        ("--trials 7", &*format!("- {trials}\n  + trials = 7")),
        ("--every-nth-cell 2", "of --every-nth-cell 1, not 2"),
        ("--shard 1/2", "of the whole study, not shard 1 of 2"),
        (
            "--target-error 0.1",
            "without --budget and --target-error, and this is with --target-error 0.1",
        ),
    ] {
        let said = desk
            .palpate(&format!("run c.toml --out o {arguments}"))
            .said(2);
        assert!(said.contains(words), "{said}");
        assert!(said.contains("use --restart"), "{said}");
        assert_eq!(fs::read(desk.path("o/journal.palpate")).unwrap(), journal);
    }
    desk.palpate("run c.toml --out o --trials 7 --restart")
        .printed();
    assert_eq!(desk.names("o"), RUN_FILES);
    // A file `journal.palpate` that is not a journal is not changed.
    desk.write("o/journal.palpate", "mine");
    desk.palpate("run c.toml --out o --trials 7")
        .fails(2, "o/journal.palpate is not a journal of palpate");
    assert_eq!(desk.read("o/journal.palpate"), "mine");
}

#[test]
fn a_resumed_run_keeps_the_chosen_number_of_trials() {
    let (desk, line) = kill_run(3_000, |times| {
        let target = 0.008 / f64::from(times).sqrt();
        format!("run c.toml --out o --threads 1 --target-error {target}")
    });
    desk.palpate(&line.replace("--out o", "--out whole"))
        .printed();
    let ended = desk.palpate(&line);
    assert!(ended.stderr.contains("note: resumes after"), "{ended:?}");
    assert_same_results(&desk, "o", "whole");
}
