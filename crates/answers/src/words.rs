//! Numbers and lists in words.

use palpate_study::{Label, number};

/// Digits of a number in a sentence.
pub(crate) const DIGITS: usize = 3;

/// Share in percent, without the sign.
pub(crate) fn percent(share: f64) -> String {
    number::significant(100.0 * share, DIGITS)
}

/// Text with a capital at its start.
pub(crate) fn capitalized(words: &str) -> String {
    let mut letters = words.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).collect()
}

/// `a`, `a and b`, `a, b and c`.
pub(crate) fn joined(words: impl IntoIterator<Item = String>) -> String {
    match words.into_iter().collect::<Vec<_>>().as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

/// Values of swept fields with their names and units.
pub(crate) fn settings_in_words(columns: &[String], values: &[String]) -> String {
    let pairs = columns.iter().zip(values).map(|(column, text)| {
        let label = Label::of_field(column);
        format!("{} {}", label.words, label.value(text))
    });
    pairs.collect::<Vec<_>>().join(", ")
}
