//! Which values of a field meet a target.

use std::time::{Duration, Instant};

use palpate::config::{Varied, Vary};
use palpate::{DesignError, Question};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};
use serde_json::Value as Json;

use crate::error;
use crate::figure::Figure;
use crate::json::{from_python, of_json, to_toml};
use crate::record::{Made, record};
use crate::study::{Study, runner};
use crate::table::Table;
use crate::watch::watched_alone;

record!(
    DesignAnswer,
    "Values of a field that meet a target, all of it right with 95 %.\n\nFields: what `palpate design --json` prints: `answer`, a sentence; `meets` and `misses`, lists of runs with `from` and\n`to`; `best` with `value`, `statistic`, `std_error` and `failing`; `target`, `path`, `unit`, `max_failures`,\n`confidence`, `narrowed` (ends of runs that fresh trials did not verify) and `ended` (\"known\", \"time\" or \"trials\"). `lines` are its\ngrounds, in words; `table` is a Table of all trials, `figure` a Figure of them."
);

/// Source that an answer is made from.
struct Answered {
    fields: Json,
    answer: palpate::Answer,
    study: palpate::Study,
}

impl Made for Answered {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_json(py, &self.fields)
    }

    fn others(&self) -> &'static [&'static str] {
        &["lines", "table", "figure"]
    }

    fn other<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        Ok(match name {
            "lines" => self.answer.lines().into_pyobject(py)?.into_any(),
            "table" => {
                let unit = self.study.config.length_unit;
                Bound::new(py, Table::new(py, self.answer.table(), unit)?)?.into_any()
            }
            _ => {
                let figure = self
                    .answer
                    .figure("design", crate::study::title(&self.study));
                let figure = figure.map_err(|error| error::RunError::new_err(error.to_string()))?;
                Bound::new(py, Figure::from(figure))?.into_any()
            }
        })
    }
}

/// The field that is varied, and its values: of a text as on the command line, or of a dictionary with one entry.
fn vary_of(vary: &Bound<'_, PyAny>) -> PyResult<Vary> {
    let wrong = |message: String| error::argument("vary", &[], None, format!("vary: {message}"));
    if let Ok(text) = vary.cast::<PyString>() {
        let parsed = text.to_cow()?.parse::<Vary>();
        return parsed.map_err(|error| wrong(error.to_string()));
    }
    let fields = vary
        .cast::<PyDict>()
        .ok()
        .filter(|fields| fields.len() == 1);
    let Some((path, values)) = fields.and_then(|fields| fields.iter().next()) else {
        let message = "must be a text such as \"scene.sensor.pitch=0.05..2\", or a dictionary of one path with a tuple \
                       (from, to) or a list of values";
        return Err(wrong(message.to_owned()));
    };
    let values = match values.cast::<PyTuple>() {
        Ok(_) => {
            let (from, to): (f64, f64) = values
                .extract()
                .map_err(|_| wrong("a range must be a tuple of two numbers".to_owned()))?;
            if !(from.is_finite() && to.is_finite() && from <= to) {
                let message = format!("the range {from} to {to} must be finite and run upwards");
                return Err(wrong(message));
            }
            Varied::Range { from, to }
        }
        Err(_) => match from_python(&values)? {
            Json::Array(items) if !items.is_empty() => Varied::Listed(
                items
                    .iter()
                    .map(|item| to_toml("vary", item))
                    .collect::<PyResult<_>>()?,
            ),
            _ => {
                return Err(wrong(
                    "values must be a tuple (from, to) or a list".to_owned(),
                ));
            }
        },
    };
    Ok(Vary {
        path: path.extract()?,
        values,
    })
}

/// Error of a question that has no answer.
fn refused(error: DesignError) -> PyErr {
    let message = error.to_string();
    match error {
        DesignError::Config(error) => error::config(error),
        DesignError::OutOfRange { setting, value, .. } => {
            let argument = if setting == "limit" {
                "target"
            } else {
                setting
            };
            error::argument(argument, &[], Some(value), message)
        }
        DesignError::NoRange { .. }
        | DesignError::NothingVaried
        | DesignError::NotVaried(_)
        | DesignError::NoOrder { .. }
        | DesignError::TooManyColumns(_) => error::argument("vary", &[], None, message),
        DesignError::Twice(_) | DesignError::TooManyCells(_) => {
            error::argument("set", &[], None, message)
        }
        DesignError::NoQuantity { .. } => error::argument("target", &[], None, message),
        DesignError::Undefined { .. } => error::RunError::new_err(message),
    }
}

/// Values of a field at which all cells of a study meet a target: which pads, which roll, which camera will do.
///
/// At least 16 values are scanned, every crossing is bracketed ever more closely, and fresh trials verify the answer, all
/// of which is right with 95 %. Between values that were looked at nothing is known.
///
/// Parameters
/// ----------
/// study : Study
///     Scene, and the cells in all of which the target is to hold at once.
/// target : str
///     "STATISTIC(QUANTITY) <= LIMIT" or ">= LIMIT", with the names of `Results.cells`, as
///     "relative_rms_error(mean_curvature) <= 5 %"; without a quantity the first of the scene is meant.
/// vary : str or dict
///     The field that is varied, with its values: "scene.sensor.pitch=0.05..2", or `{"scene.sensor.pitch": (0.05, 2)}` for
///     all numbers between, `{"scene.sensor.normal_from": ["hue", "both"]}` for these.
/// set : dict, optional
///     Fields that get one value each, in place of what the study and its sweeps say of them.
/// max_failures : float
///     Largest share of the trials that may fail, above 0; 1: however many.
/// gap : float
///     Largest gap that is to stay between what meets the target and what misses it: a share of the value where ratios
///     count, else of half the range.
/// most_trials : int
///     Most trials of a cell at one value.
/// budget : float, optional
///     Time after which nothing more is explored, s, by default 60; None: no end, and the answer hangs on the question alone. The scan and
///     the verification are always done.
/// seed, threads, progress
///     As of `Study.run`.
///
/// Returns
/// -------
/// DesignAnswer
///
/// Raises
/// ------
/// ArgumentError
///     For a target, a field or a setting that cannot be.
/// ConfigError
///     Where a value of the field makes no scene.
/// RunError
///     Where the statistic has no value.
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
#[pyo3(signature = (study, target, vary, *, set=None, max_failures=0.05, gap=0.05, most_trials=4_194_304,
    budget=Some(60.0), seed=None, threads=None, progress=None))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn design<'py>(
    py: Python<'py>,
    study: &Bound<'py, Study>,
    target: &str,
    vary: &Bound<'py, PyAny>,
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
    let set = set.iter().flat_map(|set| set.iter());
    let set = set.map(|(path, value)| {
        let path: String = path.extract()?;
        let value = to_toml(&path, &from_python(&value)?)?;
        Ok((path, value))
    });
    let question = Question {
        max_failures,
        set: set.collect::<PyResult<_>>()?,
        gap,
        most_trials,
        budget: budget.map(Duration::from_secs_f64),
        ..Question::new(target, vary_of(vary)?)
    };
    let study = study.get().with(None, seed)?;
    let runner = runner(threads)?;
    let answered = watched_alone(py, progress.as_ref(), move |watch| {
        let start = Instant::now();
        let told = std::cell::Cell::new(0);
        let tell = |_values: usize, trials: u64| {
            watch.tell(trials.saturating_sub(told.replace(trials)));
            watch.unwind_if_cancelled();
        };
        let answer = palpate::design(&study, &question, &runner, &|| start.elapsed(), &tell)?;
        Ok(Answered {
            fields: answer.to_json(&study),
            answer,
            study,
        })
    })?
    .map_err(refused)?;
    DesignAnswer::of(py, answered)
}
