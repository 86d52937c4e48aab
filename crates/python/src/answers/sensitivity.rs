//! Computes the effects of the fields of a scene on the error of an estimate.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::Found;
use super::question::{set as set_of, unanswered};
use crate::error;
use crate::record::{Record, record};
use crate::study::{Study, runner};
use crate::watch::watched;

record!(
    Sensitivity,
    "Effects of the numeric fields of a scene on the rms error of a quantity, the largest first.\n\nFields: those that `palpate sensitivity --json` prints: `effects`, each with `field`, `value`, the two compared `values`,\ntheir `rms_errors`, `effect` (relative change of the error per relative change of the field), `effect_std` and `failures`;\n`skipped` fields with the reason `why`; `quantity`, `unit`, `trials` and `rms_error`. `table` is a Table of all effects, `figure` a Figure of the largest."
);

/// Computes the effect of each numeric field of a study's scene on the rms error of a quantity.
///
/// Changes one field at a time, and uses the same random numbers for all values of the field. If the study sweeps
/// fields, only its first cell is used.
///
/// Parameters
/// ----------
/// study : Study
///     Study whose scene is changed.
/// set : dict, optional
///     Fields with one value each. They replace the values and the sweeps of the study.
/// quantity : str, optional
///     Quantity whose error is compared; by default "object_curvature" of a press, else "mean_curvature".
/// step : float
///     Relative change of each field in both directions, above 0 and at most 0.5.
/// trials : int
///     Number of trials at each value.
/// seed, threads
///     The same arguments as in `Study.run`. The results do not depend on the number of threads.
/// progress : callable, optional
///     Function that is called from time to time with the number of fields done since its last call.
///
/// Returns
/// -------
/// Sensitivity
///
/// Raises
/// ------
/// ArgumentError
///     For a quantity that the scene does not have, for a step out of its range, and if no trial has an error.
/// ConfigError
///     If the scene is not valid with one of the values.
///
/// Examples
/// --------
/// >>> study = palpate.Study({
/// ...     "name": "a-ball", "length_unit": "mm",
/// ...     "scene": palpate.scene(
/// ...         "roll", probe=palpate.surface("sphere", radius=10.0), object=palpate.surface("sphere", radius=30.0),
/// ...         motion={"arc_length": 4.0}, sensor={"kind": "wrist", "std": 0.01}),
/// ... })
/// >>> found = palpate.sensitivity(study)
/// >>> round([one.effect for one in found.effects if one.field == "scene.sensor.std_mm"][0], 2)
/// 1.0
#[pyfunction]
#[pyo3(signature = (study, *, set=None, quantity=None, step=0.05, trials=1000, seed=None, threads=None, progress=None))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn sensitivity<'py>(
    py: Python<'py>,
    study: &Bound<'py, Study>,
    set: Option<Bound<'py, PyDict>>,
    quantity: Option<String>,
    step: f64,
    trials: u64,
    seed: Option<u64>,
    threads: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let study = study.get().with(None, seed)?;
    let set = study.resolve_each(&set_of(set.as_ref())?);
    let set = set.map_err(error::config)?.into_iter();
    let set: Vec<_> = set.map(|(path, value)| (path, vec![value])).collect();
    let study = study.varied(&set).map_err(error::config)?;
    let runner = runner(threads)?;
    let found = watched(py, progress.as_ref(), move |watch| {
        let progress = |done: usize, _all: usize| watch.reach(done as u64);
        let quantity = quantity.as_deref();
        let sensitivity = palpate::sensitivity(&study, quantity, trials, step, &runner, &progress)?;
        Ok(Found {
            answer: sensitivity,
            study,
            name: "sensitivity",
        })
    })?;
    let found = found.map_err(|error| unanswered(error, "quantity"))?;
    Sensitivity::of(py, Record::new(found))
}
