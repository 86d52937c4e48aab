//! Scores of the papers' claims, and the page of studies.

use std::path::PathBuf;

use palpate::report::{Study as Scored, page, score, scorecard_lines};
use palpate::{Files, ReportError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use serde_json::json;

use crate::error;
use crate::record::Record;
use crate::study::Results;

/// Scores of the papers' claims on the results of studies, and their page.
#[pyclass(frozen, module = "palpate")]
pub(crate) struct Report {
    /// Scores, in the order of the claims: Records with `claim` (its number), `study`, `paper_says`, `measured`, `verdict`
    /// ("holds", "differs" or "not testable") and `why`.
    #[pyo3(get)]
    scores: Vec<Py<PyAny>>,
    /// The scores in words.
    #[pyo3(get)]
    text: String,
    /// Page of the studies, as HTML: scores, figures, failures and configs. It loads nothing.
    #[pyo3(get)]
    html: String,
}

#[pymethods]
impl Report {
    #[staticmethod]
    fn _restored(scores: Vec<Py<PyAny>>, text: String, html: String) -> Self {
        Self { scores, text, html }
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, own) = (slf.py(), slf.get());
        let scores = own.scores.iter().map(|score| score.bind(py));
        let scores = scores.cloned().collect::<Vec<_>>();
        let state = (scores, own.text.clone(), own.html.clone());
        let restored = slf.get_type().getattr("_restored")?;
        Ok((restored, state.into_pyobject(py)?.into_any()))
    }

    fn __repr__(&self) -> String {
        format!("<Report of {} scores>\n{}", self.scores.len(), self.text)
    }
}

/// Error of results that no page is made of.
fn refused(error: ReportError) -> PyErr {
    error::RunError::new_err(error.to_string())
}

/// Scores the published claims that the studies list (`claims = […]`), and makes a page of the studies' results.
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
pub(crate) fn report(py: Python<'_>, studies: &Bound<'_, PyTuple>) -> PyResult<Report> {
    let files = |one: Bound<'_, PyAny>| match one.cast::<Results>() {
        Ok(results) => Ok(results.get().in_memory()),
        Err(_) => Ok::<_, PyErr>(Files::in_folder(one.extract::<PathBuf>()?)),
    };
    let files: Vec<Files> = studies.iter().map(files).collect::<PyResult<_>>()?;
    let made = py.detach(|| {
        let studies = files.into_iter().map(Scored::read);
        let studies = studies.collect::<Result<Vec<_>, _>>()?;
        Ok((score(&studies), page(&studies)?))
    });
    let (scores, html) = made.map_err(refused)?;
    let record = |score: &palpate::report::Score| {
        let fields = json!({
            "claim": score.claim,
            "study": score.study,
            "paper_says": score.paper_says,
            "measured": score.measured,
            "verdict": score.verdict.to_string(),
            "why": score.why,
        });
        Ok(Bound::new(py, Record::of(py, &fields)?)?
            .into_any()
            .unbind())
    };
    Ok(Report {
        scores: scores.iter().map(record).collect::<PyResult<_>>()?,
        text: scorecard_lines(&scores),
        html,
    })
}
