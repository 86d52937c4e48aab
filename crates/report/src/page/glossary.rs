//! Section of the page with the words of `palpate explain`.

use minijinja::context;
use minijinja::value::Value;
use palpate_study::glossary::{SUBJECTS, meaning};
use palpate_study::{Quantity, Statistic};

/// Words by their subject, then quantities and statistics, which are no places to link to.
pub(super) fn section() -> Vec<Value> {
    let words = SUBJECTS.iter().map(|subject| {
        let terms = subject.terms.iter();
        let terms: Vec<Value> = terms
            .map(|term| context! { place => place(term.name), ..entry(term.name, term.meaning) })
            .collect();
        context! { title => subject.title, terms }
    });
    let quantities = Quantity::ALL.iter();
    let quantities: Vec<Value> = quantities.map(|one| entry(one.name, one.meaning)).collect();
    let statistics = Statistic::ALL.into_iter().chain([Statistic::StdBound]);
    let statistics: Vec<Value> = statistics
        .map(|one| entry(one.name(), one.meaning()))
        .collect();
    words
        .chain([
            context! { title => "Quantities", terms => quantities },
            context! { title => "Statistics of them over the trials of a cell", terms => statistics },
        ])
        .collect()
}

fn entry(name: &str, meaning: &str) -> Value {
    context! { name, meaning }
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
