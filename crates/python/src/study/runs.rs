//! Work on studies, on threads of its own.

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::{Duration, Instant};

use palpate::config::Output;
use palpate::{
    Accuracy, Check, Coverage, EvaluationTime, Family, Goal, PlanError, Ran, RunOptions, Rungs,
    Runner, Simulation, Study, SweepError, Trace, TraceError, check_outputs, resolved, trace,
};
use pyo3::prelude::*;
use serde_json::{Value as Json, json};

use crate::error;
use crate::watch::watched_alone;

/// More threads than this only cost their setting up.
const MOST_THREADS: usize = 256;

pub(crate) fn runner(threads: Option<usize>) -> PyResult<Runner> {
    let threads = match threads {
        None => None,
        Some(threads) => match NonZeroUsize::new(threads.min(MOST_THREADS)) {
            Some(threads) => Some(threads),
            None => {
                let message = "threads is 0; it must be at least 1";
                return Err(error::argument("threads", &[], Some(0.0), message));
            }
        },
    };
    let runner = Runner::new(&RunOptions {
        threads,
        ..RunOptions::default()
    });
    runner.map_err(|error| error::RunError::new_err(error.to_string()))
}

/// Error of cells that cannot be run.
fn of_sweep(error: SweepError<palpate::ConfigError>) -> PyErr {
    match error {
        SweepError::SetUp(error) => error::config(error),
        error => error::RunError::new_err(error.to_string()),
    }
}

/// Part of a study that is run.
pub(super) struct Asked {
    pub(super) study: Arc<Study>,
    /// Numbers of its cells; all of them by default.
    pub(super) cells: Option<Vec<usize>>,
    /// Whether single trials are told.
    pub(super) tells_trials: bool,
}

/// Results of a study.
pub(super) struct Found {
    pub(super) ran: Ran,
    /// Pass of the first cell, where the config asks for it.
    pub(super) trace: Option<Trace>,
}

pub(super) fn run(
    py: Python<'_>,
    asked: Asked,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Found> {
    let runner = runner(threads)?;
    let found = watched_alone(py, progress, move |watch| {
        let Asked {
            study,
            cells,
            tells_trials,
        } = asked;
        check_outputs(&study).map_err(SweepError::SetUp)?;
        let cells = cells.unwrap_or_else(|| (0..study.cell_count()).collect());
        let first = cells.first().copied();
        let simulation = Simulation::new(&study, cells, &runner);
        let mut simulation = simulation.map_err(SweepError::SetUp)?;
        if tells_trials {
            simulation = simulation.with_trials();
        }
        let ran = simulation.run(&watch.cancelled, &|trials| watch.tell(trials))?;
        let first = first.filter(|_| study.config.outputs.contains(&Output::Trace));
        let trace = first.map(|first| trace(&study, first, None));
        Ok((ran, trace))
    })?;
    let (ran, trace) = found.map_err(of_sweep)?;
    Ok(Found {
        ran,
        trace: trace.transpose().map_err(of_trace)?,
    })
}

/// Error of a pass.
pub(super) fn of_trace(error: TraceError) -> PyErr {
    match error {
        TraceError::Config(error) => error::config(error),
        error => error::RunError::new_err(error.to_string()),
    }
}

pub(super) fn check(
    py: Python<'_>,
    study: Arc<Study>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Json> {
    let runner = runner(threads)?;
    let check = watched_alone(py, progress, move |watch| {
        let start = Instant::now();
        let tell = |done: usize, _all: usize| watch.reach(done as u64);
        palpate::check(&study, &runner, &|| start.elapsed(), &tell)
    })?;
    check.map(|check| of_check(&check)).map_err(of_sweep)
}

fn of_check(check: &Check) -> Json {
    let groups = check.groups.iter().map(|group| {
        json!({
            "cells": group.cells,
            "needs": group.needs,
            "needless": group.needless,
            "rungs": of_rungs(&group.rungs),
        })
    });
    let intervals = check.intervals.iter().map(of_tested);
    json!({
        "cells": check.cells,
        "checked": check.checked,
        "set_up": check.set_up,
        "single": check.single,
        "trials": check.trials,
        "seconds": check.seconds,
        "threads": check.threads,
        "groups": groups.collect::<Vec<Json>>(),
        "intervals": intervals.collect::<Vec<Json>>(),
    })
}

fn of_tested((cells, tested): &(usize, Coverage)) -> Json {
    let measured = |family: &Family, beyond: Option<&str>| {
        json!({
            "cells": cells,
            "family": family.name,
            "beyond": beyond,
            "scenes": family.scenes,
            "coverage95": family.coverage95,
            "lowest": family.lowest,
            "holds": family.holds(),
        })
    };
    match tested {
        Coverage::Measured(family) => measured(family, None),
        Coverage::Outside(family, beyond) => measured(family, Some(beyond)),
        Coverage::NotMeasured(why) => json!({ "cells": cells, "not_tested": why }),
    }
}

fn of_rungs(rungs: &Rungs) -> Json {
    match rungs {
        Rungs::None | Rungs::NotMeasured => Json::Null,
        Rungs::AsIn(cell) => json!({ "as_in_cell": cell }),
        Rungs::Measured {
            cell,
            ladder,
            times,
        } => {
            let all = times.iter().map(|(place, time)| {
                let rung = &ladder.rungs[*place];
                json!({
                    "name": rung.name,
                    "taken": *place == ladder.taken,
                    "error": rung.accuracy.error(),
                    "cannot": match &rung.accuracy {
                        Accuracy::Error(_) => None,
                        Accuracy::Impossible(reason) => Some(reason),
                    },
                    "seconds": time.map(|time| time.seconds()),
                    "each_trial": time.map(|time| matches!(time, EvaluationTime::EachTrial(_))),
                })
            });
            json!({
                "cell": cell,
                "reason": ladder.reason,
                "tolerance": ladder.tolerance,
                "rungs": all.collect::<Vec<Json>>(),
            })
        }
    }
}

/// Text of the study that a goal chooses.
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
    let planned = watched_alone(py, None, move |_| {
        let start = Instant::now();
        let cells: Vec<usize> = (0..study.cell_count()).collect();
        palpate::plan(&study, &cells, &goal, &runner, &|| start.elapsed())
            .map(|(study, _)| resolved(&study))
    })?;
    planned.map_err(|error| match error {
        PlanError::SetUp(error) => error::config(error),
        error => error::RunError::new_err(error.to_string()),
    })
}
