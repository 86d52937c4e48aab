//! Section of the page with the words of `palpate explain`.

use minijinja::context;
use minijinja::value::Value;
use palpate_study::glossary::{SUBJECTS, Term, meaning};
use palpate_study::{Quantity, Statistic};

/// Words by their subject, then quantities and statistics.
pub(super) fn section() -> Vec<Value> {
    let quantities = Quantity::ALL.iter().map(|one| (one.name, one.meaning));
    let statistics = Statistic::ALL.into_iter().chain([Statistic::StdBound]);
    let statistics = statistics.map(|one| (one.name(), one.meaning()));
    let subject = |title: &str, terms: Vec<(&str, &str)>| {
        let terms = terms.into_iter();
        let terms: Vec<Value> = terms
            .map(|(name, meaning)| context! { name, meaning, place => address(name) })
            .collect();
        context! { title, terms }
    };
    let of = |term: &Term| (term.name, term.meaning);
    let subjects = SUBJECTS
        .iter()
        .map(|it| subject(it.title, it.terms.iter().map(of).collect()));
    subjects
        .chain([
            subject("Quantities", quantities.collect()),
            subject(
                "Statistics of them over the trials of a cell",
                statistics.collect(),
            ),
        ])
        .collect()
}

/// Place on the page of a word, if it is one: several spellings have one place.
pub(super) fn address(word: &str) -> Option<String> {
    let term = meaning(word)?;
    (term.name == word).then(|| place(word))
}

/// Place of a word on the page: its letters and digits, joined by dashes.
fn place(word: &str) -> String {
    let parts = word.split(|letter: char| !letter.is_ascii_alphanumeric());
    let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    format!("word-{}", parts.join("-"))
}
