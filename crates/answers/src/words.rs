//! Converts numbers and lists to words for sentences.

use palpate_study::{Label, number};

/// Number of significant digits of a number in a sentence.
pub(crate) const DIGITS: usize = 3;

pub(crate) fn percent(share: f64) -> String {
    number::significant(100.0 * share, DIGITS)
}

pub(crate) fn capitalized(words: &str) -> String {
    let mut letters = words.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).collect()
}

/// A list in words: `a`, `a and b`, or `a, b and c`.
pub(crate) fn joined(words: impl IntoIterator<Item = String>) -> String {
    match words.into_iter().collect::<Vec<_>>().as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

pub(crate) fn settings_in_words(columns: &[String], values: &[String]) -> String {
    let pairs = columns.iter().zip(values).map(|(column, text)| {
        let label = Label::of_field(column);
        format!("{} {}", label.words, label.value(text))
    });
    pairs.collect::<Vec<_>>().join(", ")
}
