//! Tests the options `--budget` and `--target-error` of `palpate run`. These options choose the number of trials. A run
//! writes a config with this number, and later runs of the written config need no such option.

use std::process::Child;
use std::time::{Duration, Instant};

use super::desk::{Desk, RUN_FILES, SCENE, STUDY, assert_untouched, edited};
use super::glide::GLIDE;
use super::journal::start_run;
use super::like::PRESS;

/// A study of noisy rolls on saddles. No formula gives the path of the contact on a saddle, so the model must compute
/// it numerically.
fn saddles() -> String {
    let study = edited(
        STUDY,
        r#"{ kind = "sphere", radius = 50.0 }"#,
        r#"{ kind = "saddle", a = 0.01 }"#,
    );
    edited(
        &edited(&study, "scene.object.radius", "scene.object.a"),
        "[50, 5]",
        "[0.01, 0.02]",
    )
}

#[track_caller]
fn setting(toml: &str, key: &str) -> f64 {
    let line = toml
        .lines()
        .find_map(|line| line.strip_prefix(&format!("{key} = ")));
    line.unwrap_or_else(|| panic!("no {key} in\n{toml}"))
        .parse()
        .unwrap()
}

#[test]
fn budget_and_target_are_refused_if_trials_are_swept() {
    let desk = Desk::with(&edited(
        &edited(STUDY, "scene.object.radius", "trials"),
        "[50, 5]",
        "[20, 40]",
    ));
    for argument in ["--budget 3s", "--target-error 0.1"] {
        desk.palpate(&format!("run c.toml --out o {argument}"))
            .fails(2, ": trials: is swept, so that neither");
        assert_untouched(&desk.path(""));
    }
}

#[test]
fn a_target_run_has_the_same_bytes_on_any_threads_and_in_a_rerun() {
    for (config, target) in [
        (STUDY, "0.05"),
        (&saddles(), "0.05"),
        (&edited(GLIDE, "distance = 10.0", "distance = 15.0"), "0.1"),
        (
            &edited(
                PRESS,
                "model = { kind = \"bonded-layer\"",
                "model = { kind = \"auto\"",
            ),
            "0.1",
        ),
    ] {
        let desk = Desk::with(config);
        for (out, threads) in [("one", 1), ("two", 3)] {
            let line =
                format!("run c.toml --out {out} --threads {threads} --target-error {target}");
            desk.palpate(&line).printed();
        }
        desk.palpate("run one/run.toml --out again").printed();
        assert!(setting(&desk.read("one/run.toml"), "trials") > 20.0);
        for file in RUN_FILES {
            let one = desk.read(&format!("one/{file}"));
            assert_eq!(one, desk.read(&format!("two/{file}")));
            assert_eq!(one, desk.read(&format!("again/{file}")));
        }
    }
}

#[test]
fn a_budget_sets_trials_and_its_rerun_has_the_same_bytes() {
    let desk = Desk::with(&saddles());
    desk.palpate("run c.toml --out one --budget 1s")
        .prints(" per cell with random numbers: the budget; ");
    desk.palpate("run one/run.toml --out again").printed();
    for file in RUN_FILES {
        assert_eq!(
            desk.read(&format!("one/{file}")),
            desk.read(&format!("again/{file}"))
        );
    }
}

#[test]
fn the_smaller_number_of_trials_applies() {
    let desk = Desk::with(STUDY);
    desk.palpate("run c.toml --out o --budget 1h --target-error 0.1")
        .prints("the target error decides; the budget has time for ");
    desk.palpate("run c.toml --out o --budget 1s --target-error 0.00001")
        .prints("the budget decides");
}

#[test]
fn run_toml_names_a_single_rung_and_keeps_auto_if_skipped_cells_need_another() {
    let desk = Desk::with(STUDY);
    desk.palpate("run c.toml --out o --target-error 0.1")
        .printed();
    let config = desk.read("o/run.toml");
    assert!(
        config.contains("[scene.model]\nkind = \"closed-form\"\n"),
        "{config}"
    );

    let objects =
        "[{ label = \"a\", kind = \"plane\" }, { label = \"b\", kind = \"saddle\", a = 0.01 }]";
    let study = edited(STUDY, "scene.object.radius", "scene.object");
    desk.write("c.toml", edited(&study, "[50, 5]", objects));
    for allowed in ["--target-error 0.1", "--budget 1s"] {
        desk.palpate(&format!("run c.toml --out o --every-nth-cell 2 {allowed}"))
            .printed();
        let config = desk.read("o/run.toml");
        assert!(
            config.contains("[scene.model]\nkind = \"auto\"\ntolerance = "),
            "{config}"
        );
        desk.palpate("run o/run.toml --out again --trials 2")
            .printed();
    }
}

/// Compares the chosen model with an almost exact model, with the same random numbers. No mean may differ by more than
/// a tenth of (target error × rms error).
#[test]
fn model_error_is_at_most_a_tenth_of_the_target() {
    const TARGET: f64 = 0.05;
    let desk = Desk::with(&saddles());
    desk.palpate(&format!("run c.toml --out o --target-error {TARGET}"))
        .printed();
    let config = desk.read("o/run.toml");
    let (before, model) = config.split_once("[scene.model]\n").unwrap();
    let (_, after) = model.split_once("\n\n").unwrap();
    let exact = format!("{before}[scene.model]\nkind = \"dop853\"\ntolerance = 1e-13\n\n{after}");
    desk.write("exact.toml", exact);
    desk.palpate("run exact.toml --out exact").printed();
    let (taken, exact) = (desk.table("o/cells.csv"), desk.table("exact/cells.csv"));
    let mut largest = 0.0_f64;
    for row in 0..taken.rows.len() {
        let shift = (taken.number(row, "mean") - exact.number(row, "mean")).abs();
        let allowed = 0.1 * TARGET * exact.number(row, "rms_error");
        assert!(
            shift <= allowed,
            "row {row}: {shift:e} is not within {allowed:e}"
        );
        largest = largest.max(shift);
    }
    assert!(largest > 0.0, "both runs used the same rung");
}

#[test]
fn a_noiseless_study_runs_one_trial() {
    let desk = Desk::with(SCENE);
    for argument in ["--target-error 0.1", "--budget 60s"] {
        let printed = desk
            .palpate(&format!("run c.toml --out o {argument}"))
            .printed();
        assert!(
            printed.starts_with("trials  1, because no cell has random numbers\n"),
            "{printed}"
        );
        assert!(
            printed.contains("a-study: 1 cells, 1 trials, 0 failed -> o"),
            "{printed}"
        );
        assert_eq!(setting(&desk.read("o/run.toml"), "trials"), 20.0);
    }
}

#[test]
fn heavy_tails_cause_a_warning() {
    // The error of the angular velocity is as large as the velocity itself. Estimates are quotients, so their
    // denominators may be near zero, and their errors have heavy tails.
    let desk = Desk::with(&edited(
        STUDY,
        "kind = \"uniform\", fraction = 0.01",
        "kind = \"gaussian\", fraction = 1.0",
    ));
    let ended = desk.palpate("run c.toml --out o --target-error 0.2");
    assert_eq!(ended.status, Some(0), "{ended:?}");
    assert!(
        ended.stderr.starts_with("warning: the errors of "),
        "{ended:?}"
    );
    assert!(ended.stderr.contains("have heavy tails"), "{ended:?}");
}

const ENDLESS: &str = "run c.toml --out o --trials 1000000000000 --threads 1";

fn kill_when_file_exists(desk: &Desk, mut run: Child, file: &str) {
    let start = Instant::now();
    while !desk.path(file).exists() && start.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(10));
    }
    run.kill().unwrap();
    run.wait().unwrap();
}

#[test]
fn an_interrupted_run_writes_its_config_but_no_tables() {
    let desk = Desk::with(STUDY);
    // The journal is written after the config, so the config exists when the run is killed.
    kill_when_file_exists(&desk, start_run(&desk, ENDLESS), "o/journal.palpate");
    // The lock file still exists, but no process holds the lock.
    let names = [".palpate-lock", "journal.palpate", "run.toml"];
    assert_eq!(desk.names("o"), names);
    assert_eq!(setting(&desk.read("o/run.toml"), "trials"), 1e12);
    desk.palpate("run c.toml --out o --restart").printed();
    assert_eq!(desk.names("o"), RUN_FILES);
}

#[test]
fn an_interrupted_run_does_not_touch_older_results() {
    let desk = Desk::with(STUDY);
    desk.palpate("run c.toml --out o").printed();
    let before = RUN_FILES.map(|file| desk.read(&format!("o/{file}")));
    kill_when_file_exists(&desk, start_run(&desk, ENDLESS), "o/next-run.toml");
    assert_eq!(
        RUN_FILES.map(|file| desk.read(&format!("o/{file}"))),
        before
    );
    assert_eq!(setting(&desk.read("o/next-run.toml"), "trials"), 1e12);
    // The next run that ends overwrites the files of the killed run.
    desk.palpate("run c.toml --out o --trials 30 --restart")
        .printed();
    assert_eq!(desk.names("o"), RUN_FILES);
    assert_eq!(setting(&desk.read("o/run.toml"), "trials"), 30.0);
}
