//! Scores the papers' claims, and makes the HTML page with the results of studies.

use std::path::PathBuf;

use palpate::report::{Study as Scored, page, score, scorecard_lines};
use palpate::{Files, ReportError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use serde_json::json;

use crate::error;
use crate::json::to_python;
use crate::record::{Record, record};
use crate::study::Results;

record!(
    Report,
    "Scores of the papers' claims on the results of studies, and their page.\n\nFields: `scores`, in the order of the claims, each with `claim` (its number), `study`, `paper_says`, `measured`,\n`verdict` (\"holds\", \"differs\" or \"not testable\") and `why`; `text`, the scores in words; `html`, the page of the studies:\nscores, figures, failures and configs. The page loads no other files."
);

/// Tests the published claims that the studies list (`claims = […]`), and makes a page of the studies' results.
///
/// Parameters
/// ----------
/// *studies : Results or path
///     Results of studies, or directories that `palpate run` wrote. If all directories have the same parent, the
///     page also shows the measurements in the parent's `tradeoff/` and `peers.csv`.
///
/// Returns
/// -------
/// Report
///
/// Raises
/// ------
/// RunError
///     If a directory has no results, or if a plot cannot be drawn.
///
/// Examples
/// --------
/// >>> study = palpate.Study({
/// ...     "name": "a-ball", "length_unit": "mm", "trials": 100, "claims": [2],
/// ...     "scene": palpate.scene(
/// ...         "roll", probe=palpate.surface("sphere", radius=10.0), object=palpate.surface("sphere", radius=30.0),
/// ...         motion={"rate_rad_per_s": 0.1, "duration_s": 1.0}),
/// ... })
/// >>> # A single roll length cannot show whether the length matters.
/// >>> palpate.report(study.run()).scores[0].verdict
/// 'not testable'
#[pyfunction]
#[pyo3(signature = (*studies))]
pub(crate) fn report<'py>(
    py: Python<'py>,
    studies: &Bound<'py, PyTuple>,
) -> PyResult<Bound<'py, PyAny>> {
    let files = |one: Bound<'_, PyAny>| match one.cast::<Results>() {
        Ok(results) => Ok(results.get().in_memory()),
        Err(_) => Ok::<_, PyErr>(Files::in_folder(one.extract::<PathBuf>()?)),
    };
    let files: Vec<Files> = studies.iter().map(files).collect::<PyResult<_>>()?;
    let made = py.detach(|| {
        let studies = files.into_iter().map(Scored::read);
        let studies = studies.collect::<Result<Vec<_>, _>>()?;
        Ok::<_, ReportError>((score(&studies), page(&studies)?))
    });
    let (scores, html) = made.map_err(error::run)?;
    let score = |score: &palpate::report::Score| {
        json!({
            "claim": score.claim,
            "study": score.study,
            "paper_says": score.paper_says,
            "measured": score.measured,
            "verdict": score.verdict.to_string(),
            "why": score.why,
        })
    };
    let fields = json!({ "scores": scores.iter().map(score).collect::<Vec<_>>() });
    let arrays = PyDict::new(py);
    arrays.set_item("text", scorecard_lines(&scores))?;
    arrays.set_item("html", html)?;
    let fields = to_python(py, &fields)?.cast_into()?;
    Report::of(py, Record::restored(fields, Some(arrays)))
}
