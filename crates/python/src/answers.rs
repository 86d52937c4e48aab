//! Answers questions about sensors by Monte Carlo simulation. Also scores the papers' claims and explains words.

pub(crate) mod design;
pub(crate) mod distinguish;
mod question;
pub(crate) mod report;
pub(crate) mod sensitivity;

use palpate::glossary::{SUBJECTS, meaning, similar};
use palpate::{Answer, Quantity, ReportError, Statistic, Study, Table as Rows};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error;
use crate::figure::Figure;
use crate::json::to_python;
use crate::record::Made;

/// An answer with a table and a figure.
struct Found<A> {
    answer: A,
    study: Study,
    /// Name of the figure.
    name: &'static str,
}

impl<A: Answer + Send + Sync> Made for Found<A> {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.answer.to_json(&self.study))
    }

    fn others(&self) -> &'static [&'static str] {
        &["table", "figure"]
    }

    fn other<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        match name {
            "table" => table(py, &self.answer.table(), &self.study),
            _ => figure(py, self.answer.figure(self.name, self.study.heading())),
        }
    }
}

fn table<'py>(py: Python<'py>, rows: &Rows, study: &Study) -> PyResult<Bound<'py, PyAny>> {
    crate::table::table_of(py, rows, study.config.length_unit)
}

fn figure<'py>(
    py: Python<'py>,
    figure: Result<palpate::Figure, ReportError>,
) -> PyResult<Bound<'py, PyAny>> {
    let figure = figure.map_err(error::run)?;
    Ok(Bound::new(py, Figure::from(figure))?.into_any())
}

/// Returns the meaning of a word that palpate uses, for example "pitch", "unresolved" or "coverage95".
///
/// Parameters
/// ----------
/// word : str, optional
///     The word in any spelling. By default all words: a dictionary of subjects, each a dictionary of words with meanings.
///
/// Raises
/// ------
/// ArgumentError
///     For a word that palpate does not explain. The message lists similar words.
///
/// Examples
/// --------
/// >>> palpate.explain("relative curvature")[:45]
/// 'Curvature of the sensor plus curvature of the'
/// >>> "indentation" in palpate.explain()["Surfaces and contact"]
/// True
#[pyfunction]
#[pyo3(signature = (word=None))]
pub(crate) fn explain<'py>(py: Python<'py>, word: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
    let Some(word) = word else {
        return Ok(all(py)?.into_any());
    };
    let term = meaning(word).ok_or_else(|| {
        let hint = match similar(word).as_slice() {
            [] => "palpate.explain() has all words".to_owned(),
            similar => format!("did you mean {}?", similar.join(", ")),
        };
        let message = format!("word: {word:?} is not a word of palpate; {hint}");
        error::argument("word", &[], None, message)
    })?;
    Ok(term.meaning.into_pyobject(py)?.into_any())
}

fn all(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let by_subject = PyDict::new(py);
    let add = |subject: &str, terms: &mut dyn Iterator<Item = (&str, &str)>| {
        let by_word = PyDict::new(py);
        for (word, meaning) in terms {
            by_word.set_item(word, meaning.trim())?;
        }
        by_subject.set_item(subject, by_word)
    };
    for subject in SUBJECTS {
        let mut terms = subject.terms.iter().map(|term| (term.name, term.meaning));
        add(subject.title, &mut terms)?;
    }
    let mut quantities = Quantity::ALL.iter().map(|one| (one.name, one.meaning));
    add("Quantities", &mut quantities)?;
    let statistics = Statistic::ALL.into_iter().chain([Statistic::StdBound]);
    let mut statistics = statistics.map(|one| (one.name(), one.meaning()));
    add("Statistics", &mut statistics)?;
    Ok(by_subject)
}
