//! `palpate check`.

use std::fmt::Write;
use std::time::{Duration, Instant};

use palpate_scene::config;
use palpate_sweep::Cell;

use crate::cli::CheckArgs;
use crate::duration::roughly;
use crate::failure::Failure;
use crate::output;
use crate::pace::{self, Pace};
use crate::trial::SceneTrial;

/// How long trials are timed.
const TIMING: Duration = Duration::from_millis(300);

pub(crate) fn check(args: &CheckArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let study = config::load(&args.config).map_err(Failure::usage)?;
    let scenes: Vec<SceneTrial> = (0..study.cells.len())
        .map(|cell| study.estimable_scene(cell).map(SceneTrial))
        .collect::<Result<_, _>>()
        .map_err(Failure::usage)?;
    let planning = start.elapsed();
    let cells: Vec<Cell<'_>> = scenes
        .iter()
        .zip(&study.cells)
        .map(|(trial, cell)| Cell {
            trials: trial.0.trials(cell.config.trials),
            trial,
        })
        .collect();
    let trials: Vec<u64> = cells.iter().map(|cell| cell.trials).collect();

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
    let threads = pace::threads(None);
    let pace = Pace::of(&cells, threads, TIMING).map_err(Failure::work)?;
    let seconds = planning.as_secs_f64() + pace.run_seconds(&trials, threads);
    let _ = write!(
        text,
        "time    about {} on {threads} threads, planning included",
        roughly(seconds)
    );
    output::print(&text)
}

/// The models that cells need, each with the number of cells that need them.
fn distinct_needs(scenes: &[SceneTrial]) -> Vec<(Vec<String>, usize)> {
    let mut groups: Vec<(Vec<String>, usize)> = Vec::new();
    for needs in scenes.iter().map(|scene| scene.0.needs()) {
        match groups.iter_mut().find(|(known, _)| *known == needs) {
            Some((_, count)) => *count += 1,
            None => groups.push((needs, 1)),
        }
    }
    groups
}
