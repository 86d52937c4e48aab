//! Words and what they mean.

use palpate::glossary::{SUBJECTS, meaning, similar};
use palpate::{Quantity, Statistic};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error;

/// Meaning of a word that palpate prints or asks for: "pitch", "unresolved", "coverage95".
///
/// Parameters
/// ----------
/// word : str, optional
///     However it is spelt. Without one, all words: dictionaries of meanings by the words, by their subject.
///
/// Raises
/// ------
/// ArgumentError
///     For a word that palpate does not have, with those that resemble it.
///
/// Examples
/// --------
/// >>> palpate.explain("relative curvature")[:45]
/// 'Curvature of the sensor plus that of the obje'
/// >>> "indentation" in palpate.explain()["Surfaces and contact"]
/// True
#[pyfunction]
#[pyo3(signature = (word=None))]
pub(crate) fn explain<'py>(py: Python<'py>, word: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
    let Some(word) = word else {
        return Ok(all(py)?.into_any());
    };
    let term = meaning(word).ok_or_else(|| {
        let known = match similar(word).as_slice() {
            [] => "palpate.explain() has all words".to_owned(),
            known => format!("did you mean {}?", known.join(", ")),
        };
        let message = format!("word: {word:?} is no word of palpate; {known}");
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
