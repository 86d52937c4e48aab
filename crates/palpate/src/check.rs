//! `palpate check`.

use std::fmt::Write;
use std::time::{Duration, Instant};

use palpate_scene::{Scene, config};

use crate::cli::CheckArgs;
use crate::failure::Failure;
use crate::output;

/// How many cells are tried for the estimate of the time, and how long each.
const PILOTS: usize = 12;
const PILOT_TIME: Duration = Duration::from_millis(10);

pub(crate) fn check(args: &CheckArgs) -> Result<(), Failure> {
    let study = config::load(&args.config).map_err(Failure::usage)?;
    let scenes: Vec<Scene> = (0..study.cells.len())
        .map(|cell| study.estimable_scene(cell))
        .collect::<Result<_, _>>()
        .map_err(Failure::usage)?;
    let trials: Vec<u64> = scenes
        .iter()
        .zip(&study.cells)
        .map(|(scene, cell)| scene.trials(cell.config.trials))
        .collect();

    let mut text = String::new();
    let noiseless = trials.iter().filter(|&&trials| trials == 1).count();
    let _ = writeln!(text, "study   {}", study.config.name);
    let _ = writeln!(
        text,
        "cells   {}, of which {noiseless} run a single trial",
        scenes.len()
    );
    let _ = writeln!(text, "trials  {}", trials.iter().sum::<u64>());
    let _ = writeln!(text, "models");
    for (needs, cells) in distinct_needs(&scenes) {
        let _ = writeln!(text, "  {cells} of {} cells", scenes.len());
        for need in needs {
            let _ = writeln!(text, "    {need}");
        }
    }
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let seconds = expected_seconds(&scenes, &trials) / threads as f64;
    let _ = write!(
        text,
        "time    about {} on {threads} threads",
        duration(seconds)
    );
    output::print(&text)
}

/// The models that cells need, each with the number of cells that need them.
fn distinct_needs(scenes: &[Scene]) -> Vec<(Vec<String>, usize)> {
    let mut groups: Vec<(Vec<String>, usize)> = Vec::new();
    for needs in scenes.iter().map(Scene::needs) {
        match groups.iter_mut().find(|(known, _)| *known == needs) {
            Some((_, count)) => *count += 1,
            None => groups.push((needs, 1)),
        }
    }
    groups
}

/// Single-threaded time of all trials, from a pilot run of some cells.
fn expected_seconds(scenes: &[Scene], trials: &[u64]) -> f64 {
    let step = scenes.len().div_ceil(PILOTS).max(1);
    let (mut sampled_trials, mut sampled_seconds, mut all_trials) = (0.0, 0.0, 0.0);
    for (index, (scene, &wanted)) in scenes.iter().zip(trials).enumerate() {
        all_trials += wanted as f64;
        if index % step == 0 {
            sampled_trials += wanted as f64;
            sampled_seconds += wanted as f64 * seconds_per_trial(scene, wanted);
        }
    }
    all_trials * sampled_seconds / f64::max(sampled_trials, 1.0)
}

fn seconds_per_trial(scene: &Scene, most: u64) -> f64 {
    let start = Instant::now();
    let mut sum = 0.0;
    let mut done = 0;
    while done < most.max(1) && (done == 0 || start.elapsed() < PILOT_TIME) {
        // Twice as many each time: a slow trial is run once, and quick ones are not timed one by one.
        let until = (2 * done).clamp(1, most.max(1));
        for trial in done..until {
            // A trial that fails takes its time too.
            let _ = scene.trial(trial, |_, outcome| sum += outcome.estimate);
        }
        done = until;
    }
    std::hint::black_box(sum);
    start.elapsed().as_secs_f64() / done as f64
}

fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "a second".to_owned(),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}
