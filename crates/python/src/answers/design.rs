//! Finds values of a config's fields with which a study meets a target.

use std::time::{Duration, Instant};

use palpate::{Answer, AnswerError, Extreme, Question, Region, Sought};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::question::{set as set_of, unanswered, varied};
use super::{figure, table};
use crate::error;
use crate::json::to_python;
use crate::record::{Made, Record, record};
use crate::study::{Study, runner};
use crate::watch::watched;

record!(
    DesignAnswer,
    "Values of one or several fields with which a study meets a target. The answer as a whole is right with a probability of 95 %.\n\nFields: those that `palpate design --json` prints: `answer`, a sentence; `columns`, one per combination of the grid, each with\n`at` (values by their paths: `column.at[\"scene.object.radius\"]`), `meets` and `misses`, lists of runs of the searched\nfield with `from` and `to`, `best` and `failing_end` with `value`, `statistic`, `std_error`, `failing` and `main_failure`,\n`narrowed` (ends of runs that new trials did not verify) and `ended` (\"known\", \"time\" or \"trials\"). If a single field is\nvaried, the fields of its only column are also fields of the answer. `best_that_meets` has values by their paths, or is\nNone; `grid`, `path`, `unit`, `target`, `max_failures`, `confidence` and `sought` repeat the question. `lines` are details\nin words, `table` is a Table of all trials, `runs` a Table of the runs that meet or miss the target, `figure` a Figure of\nthem."
);

struct Found {
    region: Region,
    study: palpate::Study,
}

impl Made for Found {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.region.to_json(&self.study))
    }

    fn others(&self) -> &'static [&'static str] {
        &["lines", "table", "runs", "figure"]
    }

    fn other<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let Self { region, study } = self;
        match name {
            "lines" => Ok(region.lines()[1..].into_pyobject(py)?.into_any()),
            "table" => table(py, &region.table(), study),
            "runs" => table(py, &region.runs(), study),
            _ => figure(py, region.figure("design", study.heading())),
        }
    }
}

/// Finds values of fields with which all cells of a study meet a target, for example a pad pitch, a roll length or a
/// camera.
///
/// The search tries at least 16 values. If a value meets the target and the next tried value misses it, the search
/// tries values between the two. New trials verify the answer, which is right with a probability of 95 %. The search
/// tests only the tried values, not the values between them. If several fields are varied, the search runs over one
/// field, at each combination of the values of the other fields.
///
/// Parameters
/// ----------
/// study : Study
///     Study whose cells must all meet the target.
/// target : str
///     "STATISTIC(QUANTITY) <= LIMIT" or ">= LIMIT", with the names of `Results.cells`, for example
///     "relative_rms_error(mean_curvature) <= 5 %". The default quantity is the first quantity of the scene.
/// vary : str, list of str, or dict
///     The varied fields with their values: "scene.sensor.pitch=0.05..2" or `{"scene.sensor.pitch": (0.05, 2)}` for a
///     range, `{"scene.sensor.normal_from": ["hue", "both"]}` for a list.
/// maximise, minimise : str, optional
///     Path of a varied field. The answer states the largest, or smallest, value of this field that meets the target.
///     Give at most one of the two arguments.
/// set : dict, optional
///     Fields with one value each. They replace the values and the sweeps of the study.
/// max_failures : float
///     Largest share of the trials that may fail, above 0 and at most 1.
/// gap : float
///     Largest gap between a value that meets the target and the next value that misses it. If the tried values have
///     logarithmic spacing, the gap is relative to the value; otherwise, it is relative to half the range.
/// most_trials : int
///     Largest number of trials of each cell at one tried value.
/// budget : float, optional
///     Time limit of the search, s, by default 60. The first values and the verification always run. With None there is
///     no time limit, and the answer does not depend on the speed of the machine.
/// seed, threads, progress
///     The same arguments as in `Study.run`.
///
/// Returns
/// -------
/// DesignAnswer
///
/// Raises
/// ------
/// ArgumentError
///     For an invalid target, field or setting.
/// ConfigError
///     If the scene is not valid with one of the values.
/// RunError
///     If the statistic has no value.
///
/// Examples
/// --------
/// >>> study = palpate.Study({
/// ...     "name": "a-ball", "length_unit": "mm",
/// ...     "scene": palpate.scene(
/// ...         "roll", probe=palpate.surface("sphere", radius=10.0), object=palpate.surface("sphere", radius=30.0),
/// ...         motion={"rate_rad_per_s": 0.5, "duration_s": 1.0},
/// ...         sensor={"kind": "pads", "pitch": 0.5, "layout": "uniform", "offset": "random"}),
/// ... })
/// >>> found = palpate.design(study, "relative_rms_error(mean_curvature) <= 5 %", {"scene.sensor.pitch": (0.05, 1)})
/// >>> 0.2 < found.meets[0].to < 0.8
/// True
#[pyfunction]
#[pyo3(signature = (study, target, vary, *, maximise=None, minimise=None, set=None, max_failures=0.05,
    gap=0.05, most_trials=4_194_304, budget=Some(60.0), seed=None, threads=None, progress=None))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn design<'py>(
    py: Python<'py>,
    study: &Bound<'py, Study>,
    target: &str,
    vary: &Bound<'py, PyAny>,
    maximise: Option<String>,
    minimise: Option<String>,
    set: Option<Bound<'py, PyDict>>,
    max_failures: f64,
    gap: f64,
    most_trials: u64,
    budget: Option<f64>,
    seed: Option<u64>,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let target = target.parse().map_err(|error: palpate::TargetError| {
        error::argument("target", &[], None, format!("target: {error}"))
    })?;
    if let Some(seconds) = budget.filter(|seconds| !(*seconds > 0.0 && *seconds <= 1e10)) {
        let message = format!("budget is {seconds}; it must be > 0 and <= 1e10");
        return Err(error::argument("budget", &[], Some(seconds), message));
    }
    let (argument, extreme, path) = match (maximise, minimise) {
        (Some(_), Some(_)) => {
            let message = "minimise and maximise cannot be combined: give one of them";
            return Err(error::argument("minimise", &[], None, message));
        }
        (Some(path), None) => ("maximise", Extreme::Largest, Some(path)),
        (None, path) => ("minimise", Extreme::Smallest, path),
    };
    let study = study.get().with(None, seed)?;
    let path = path.map(|name| study.path_of(&name)).transpose();
    let sought = path
        .map_err(error::config)?
        .map(|path| Sought { path, extreme });
    let vary = varied(vary)?.into_iter().map(|vary| study.resolve(&vary));
    let vary: Result<Vec<_>, _> = vary.collect();
    let question = Question::new(target, vary.map_err(error::config)?, sought);
    let question = question.map_err(|error| match error {
        AnswerError::NotVaried(_) => error::argument(argument, &[], None, error.to_string()),
        error => unanswered(error, "target"),
    })?;
    let set = study.resolve_each(&set_of(set.as_ref())?);
    let question = Question {
        set: set.map_err(error::config)?,
        max_failures,
        gap,
        most_trials,
        budget: budget.map(Duration::from_secs_f64),
        ..question
    };
    let runner = runner(threads)?;
    let found = watched(py, progress.as_ref(), move |watch| {
        let start = Instant::now();
        let (clock, progress) = (
            || start.elapsed(),
            |_values: usize, trials: u64| watch.reach(trials),
        );
        let region = palpate::design(&study, &question, &runner, &clock, &progress)?;
        Ok(Found { region, study })
    })?;
    let found = found.map_err(|error| unanswered(error, "target"))?;
    DesignAnswer::of(py, Record::new(found))
}
