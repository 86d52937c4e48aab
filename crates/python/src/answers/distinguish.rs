//! How surely objects are told apart.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::answer_display::{figure, table};
use super::question::{listed, set as set_of, unanswered, wrong};
use crate::error;
use crate::json::of_json;
use crate::record::{Made, record};
use crate::study::{Study, runner};
use crate::watch::watched_alone;

record!(
    ToldApart,
    "How surely one trial of each of two objects puts them in the right order, and how many trials do.\n\nFields: what `palpate distinguish --json` prints: `answer`, a sentence for every two neighbours; `groups`, each with\n`settings`, `objects` with the share of their trials that fail, `failing`, and the most frequent kind, `main_failure`, and `pairs` of `first`, `second`, `told_apart` (a probability, None where they are alike), `low95`, `high95`\nand `repeats`; `quantity` and `confidence`. `table` is a Table of all pairs, `figure` a Figure of them."
);

/// Source that an answer is made from.
struct Told {
    told: palpate::Discrimination,
    study: palpate::Study,
}

impl Made for Told {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_json(py, &self.told.to_json(&self.study))
    }

    fn others(&self) -> &'static [&'static str] {
        &["table", "figure"]
    }

    fn other<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let Self { told, study } = self;
        match name {
            "table" => table(py, &told.table(), study),
            _ => figure(py, told.figure("distinguish", study.heading())),
        }
    }
}

/// How surely one trial of each of two objects tells them apart, for every two objects that a study sweeps, and how many
/// trials do.
///
/// Two objects are told apart where a trial of each puts their estimates in the right order; by the quantity "class" of a
/// glide, where most places of both are classified right. A trial that fails does not tell.
///
/// Parameters
/// ----------
/// study : Study
///     Scene; its swept fields of `scene.object` make the objects, the others the groups.
/// vary : dict, optional
///     Fields of the object with lists of values, in place of what the study says of them:
///     `{"scene.object.radius": [20, 25, 30]}`.
/// set : dict, optional
///     Fields that get one value each, in place of what the study and its sweeps say of them.
/// quantity : str, optional
///     Quantity by which objects are told apart; by default "object_curvature" of a press, else "mean_curvature".
/// confidence : float
///     Probability that the mean of several trials is to reach, above 0 and below 1.
/// trials, seed, threads
///     As of `Study.run`; no result depends on the threads.
/// progress : callable, optional
///     Called now and then with the number of cells done since it was last called.
///
/// Returns
/// -------
/// ToldApart
///
/// Raises
/// ------
/// ArgumentError
///     Where there is nothing to tell apart, for a quantity that the scene does not have, and a confidence out of its range.
/// ConfigError
///     Where a value of a field makes no scene.
///
/// Examples
/// --------
/// >>> study = palpate.Study({
/// ...     "name": "a-ball", "length_unit": "mm", "trials": 2000,
/// ...     "scene": palpate.scene(
/// ...         "roll", probe=palpate.surface("sphere", radius=10.0), object=palpate.surface("sphere", radius=30.0),
/// ...         motion={"rate_rad_per_s": 0.1, "duration_s": 1.0},
/// ...         noise={"angular_velocity": {"kind": "uniform", "fraction": 0.05}}),
/// ... })
/// >>> told = palpate.distinguish(study, vary={"scene.object.radius": [20, 21, 60]})
/// >>> [pair.told_apart > 0.99 for pair in told.groups[0].pairs]
/// [True, True, False]
#[pyfunction]
#[pyo3(signature = (study, *, vary=None, set=None, quantity=None, confidence=0.95, trials=None, seed=None, threads=None,
    progress=None))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn distinguish<'py>(
    py: Python<'py>,
    study: &Bound<'py, Study>,
    vary: Option<Bound<'py, PyDict>>,
    set: Option<Bound<'py, PyDict>>,
    quantity: Option<String>,
    confidence: f64,
    trials: Option<u64>,
    seed: Option<u64>,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let mut fields = Vec::new();
    for (path, values) in vary.iter().flat_map(|vary| vary.iter()) {
        let path: String = path.extract()?;
        let values = listed(&path, &values)?;
        let values = values.ok_or_else(|| {
            wrong(format!(
                "objects are told apart one by one: list the values of {path}"
            ))
        })?;
        fields.push((path, values));
    }
    let set = set_of(set.as_ref())?.into_iter();
    fields.extend(set.map(|(path, value)| (path, vec![value])));
    let mut study = study.get().with(trials, seed)?;
    if !fields.is_empty() {
        let resolved = fields
            .iter()
            .map(|(name, values)| study.resolve_values(name, values));
        let resolved: Result<Vec<_>, _> = resolved.collect();
        let fields = resolved.map_err(error::config)?;
        study = study.varied(&fields).map_err(error::config)?;
    }
    let runner = runner(threads)?;
    let told = watched_alone(py, progress.as_ref(), move |watch| {
        let tell = |done: usize, _all: usize| watch.reach(done as u64);
        let told = palpate::distinguish(&study, quantity.as_deref(), confidence, &runner, &tell)?;
        Ok(Told { told, study })
    })?;
    let told = told.map_err(|error| unanswered(error, "quantity"))?;
    ToldApart::of(py, told)
}
