//! Runs, checks and plans studies on other threads, so that Ctrl-C can stop the work.

use std::sync::Arc;
use std::time::{Duration, Instant};

use palpate::config::Output;
use palpate::{
    Goal, PlanError, Ran, RunOptions, Runner, Simulation, Study, SweepError, Trace, TraceError,
    check_outputs, resolved, trace,
};
use pyo3::prelude::*;
use serde_json::Value as Json;

use crate::error;
use crate::watch::{threads, watched};

pub(crate) fn runner(threads: Option<usize>) -> PyResult<Runner> {
    let runner = Runner::new(&RunOptions {
        threads: self::threads(threads)?,
        ..RunOptions::default()
    });
    runner.map_err(error::run)
}

fn of_sweep(error: SweepError<palpate::ConfigError>) -> PyErr {
    match error {
        SweepError::SetUp(error) => error::config(error),
        error => error::run(error),
    }
}

/// Runs the given cells of a study; with `None`, runs all cells. Returns the results and, if the config requests a
/// trace, the trace of the first of these cells.
pub(super) fn run(
    py: Python<'_>,
    (study, cells): (Arc<Study>, Option<Vec<usize>>),
    with_trials: bool,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Ran, Option<Trace>)> {
    let runner = runner(threads)?;
    let found = watched(py, progress, move |watch| {
        check_outputs(&study).map_err(SweepError::SetUp)?;
        let cells = cells.unwrap_or_else(|| (0..study.cell_count()).collect());
        let first = cells.first().copied();
        let simulation = Simulation::new(&study, cells, &runner);
        let mut simulation = simulation.map_err(SweepError::SetUp)?;
        simulation.has_trials = with_trials;
        let ran = simulation.run(&watch.cancelled, &|trials| watch.add(trials))?;
        let first = first.filter(|_| study.config.outputs.contains(&Output::Trace));
        let trace = first.map(|first| trace(&study, first, None));
        Ok((ran, trace))
    })?;
    let (ran, trace) = found.map_err(of_sweep)?;
    Ok((ran, trace.transpose().map_err(of_trace)?))
}

pub(super) fn of_trace(error: TraceError) -> PyErr {
    match error {
        TraceError::Config(error) => error::config(error),
        error => error::run(error),
    }
}

pub(super) fn check(
    py: Python<'_>,
    study: Arc<Study>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Json> {
    let runner = runner(threads)?;
    let check = watched(py, progress, move |watch| {
        let start = Instant::now();
        let progress = |done: usize, _all: usize| watch.reach(done as u64);
        palpate::check(&study, &runner, &|| start.elapsed(), &progress)
    })?;
    check.map(|check| check.to_json()).map_err(of_sweep)
}

/// Chooses the number of trials and the model of a study for a time budget, a target error, or both. Returns the config
/// of the study with both choices, as TOML text.
pub(super) fn plan(
    py: Python<'_>,
    study: Arc<Study>,
    budget: Option<f64>,
    target_error: Option<f64>,
    threads: Option<usize>,
) -> PyResult<String> {
    for (name, value) in [("budget", budget), ("target_error", target_error)] {
        if let Some(value) = value.filter(|value| !(*value > 0.0 && *value <= 1e10)) {
            let message = format!("{name} is {value}; it must be > 0 and <= 1e10");
            return Err(error::argument(name, &[], Some(value), message));
        }
    }
    let goal = Goal {
        budget: budget.map(Duration::from_secs_f64),
        target_error,
    };
    if goal == Goal::default() {
        let message = "needs budget, target_error or both";
        return Err(error::argument("budget", &[], None, message));
    }
    let runner = runner(threads)?;
    let planned = watched(py, None, move |_| {
        let start = Instant::now();
        let cells: Vec<usize> = (0..study.cell_count()).collect();
        palpate::plan(&study, &cells, &goal, &runner, &|| start.elapsed())
            .map(|(study, _)| resolved(&study))
    })?;
    planned.map_err(|error| match error {
        PlanError::SetUp(error) => error::config(error),
        error => error::run(error),
    })
}
