//! Computes how often single trials put objects in the right order.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::Found;
use super::question::{listed, set as set_of, unanswered, wrong};
use crate::error;
use crate::record::{Record, record};
use crate::study::{Study, runner};
use crate::watch::watched;

record!(
    Distinction,
    "Probabilities that one trial of each of two objects puts their estimates in the right order, and the number of\ntrials that suffices.\n\nFields: those that `palpate distinguish --json` prints: `answer`, a sentence for every two neighbours; `groups`, each with\n`settings`, `objects` with the share of their trials that fail, `failing`, and the most frequent kind, `main_failure`, and `pairs`\nof `first`, `second`, `told_apart` (a probability, None if they are equal), `low95`, `high95` and `repeats`; `quantity` and `confidence`. `table` is a Table of all pairs, `figure` a Figure of them."
);

/// Computes, for every pair of objects in a sweep, how often the estimates of single trials put the two objects in the
/// right order. Also computes how many trials must be averaged for a reliable order.
///
/// For the quantity "class" of a glide, two trials count as being in the right order if most points of both patches are
/// classified correctly. A pair with a failed trial counts as being in the wrong order.
///
/// Parameters
/// ----------
/// study : Study
///     Study that sweeps fields of `scene.object`. Each combination of their values is an object. Objects are compared
///     only if all other swept fields have the same values.
/// vary : dict, optional
///     Fields of the object, each with a list of values that replaces the value in the study:
///     `{"scene.object.radius": [20, 25, 30]}`.
/// set : dict, optional
///     Fields with one value each. They replace the values and the sweeps of the study.
/// quantity : str, optional
///     Quantity by whose estimates the objects are put in order; by default "object_curvature" of a press, otherwise
///     "mean_curvature".
/// confidence : float
///     Required probability of the right order if the estimates of several trials are averaged, above 0 and below 1.
/// trials, seed, threads
///     The same arguments as in `Study.run`. The results do not depend on the number of threads.
/// progress : callable, optional
///     Function that is called from time to time with the number of cells done since its last call.
///
/// Returns
/// -------
/// Distinction
///
/// Raises
/// ------
/// ArgumentError
///     If there are no two objects, for a quantity that the scene does not have, and for a confidence out of its range.
/// ConfigError
///     If the scene is not valid with one of the values.
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
/// >>> found = palpate.distinguish(study, vary={"scene.object.radius": [20, 21, 60]})
/// >>> [pair.told_apart > 0.99 for pair in found.groups[0].pairs]
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
                "objects are distinguished one by one: list the values of {path}"
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
    let found = watched(py, progress.as_ref(), move |watch| {
        let progress = |done: usize, _all: usize| watch.reach(done as u64);
        let quantity = quantity.as_deref();
        let discrimination =
            palpate::distinguish(&study, quantity, confidence, &runner, &progress)?;
        Ok(Found {
            answer: discrimination,
            study,
            name: "distinguish",
        })
    })?;
    let found = found.map_err(|error| unanswered(error, "quantity"))?;
    Distinction::of(py, Record::new(found))
}
