//! Texts for column labels, numbers of trials, and costs of models.

use palpate_study::label::{self, spoken_unit};
use palpate_study::{Label, Statistic, number};

pub(crate) fn statistic(name: &str, quantities: &[&str], unit: &str) -> Label {
    let other = || {
        let quantities: Vec<String> = quantities
            .iter()
            .map(|name| label::quantity(name))
            .collect();
        Label {
            words: format!("{} of {}", name.replace('_', " "), quantities.join(", ")),
            unit: spoken_unit(unit),
            factor: 1.0,
        }
    };
    Statistic::named(name).map_or_else(other, |statistic| statistic.label(quantities, unit))
}

/// Short name of a statistic for a legend whose heading already names the quantity.
pub(crate) fn short_statistic(name: &str) -> String {
    let known = Statistic::named(name).map(Statistic::short);
    known.map_or_else(|| name.replace('_', " "), str::to_owned)
}

/// Text with the number of trials per point of a plot, or per cell of a study. `trials` are the numbers of trials of
/// all points or cells, and `of` is "point" or "cell".
pub(crate) fn sample(trials: impl Iterator<Item = f64>, of: &str) -> String {
    let mut trials: Vec<u64> = trials.map(|n| n as u64).collect();
    trials.sort_unstable();
    trials.dedup();
    match trials.as_slice() {
        [] | [1] => "nothing is random".to_owned(),
        [n] => format!("{} trials per {of}", number::grouped(*n)),
        [1, n] => format!(
            "{} trials per {of} (1 where nothing is random)",
            number::grouped(*n)
        ),
        [least, .., most] => format!(
            "{} to {} trials per {of}",
            number::grouped(*least),
            number::grouped(*most)
        ),
    }
}

/// The sentence "For `shared`: `then`." Here `shared` are settings that are the same for all points of a plot, and
/// `then` is the rest of the sentence.
pub(crate) fn sentence(shared: &[String], then: &str) -> String {
    let shared = match shared {
        [] => String::new(),
        [one] => format!("for {one}: "),
        [others @ .., last] => format!("for {} and {last}: ", others.join(", ")),
    };
    let text = format!("{shared}{then}.");
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}

/// Text of a model's cost: the time (`ns`, in nanoseconds), the number of instructions, or both. A number that is
/// `None` is left out.
pub(crate) fn cost(instructions: Option<f64>, ns: Option<f64>) -> String {
    let time = ns.map(|ns| match ns {
        _ if ns < 1e3 => format!("{} ns", number::significant(ns, 2)),
        _ if ns < 1e6 => format!("{} µs", number::significant(ns / 1e3, 2)),
        _ if ns < 1e9 => format!("{} ms", number::significant(ns / 1e6, 2)),
        _ => format!("{} s", number::significant(ns / 1e9, 2)),
    });
    let counted = instructions.map(|count| match count {
        _ if count < 1e3 => format!("{count} instructions"),
        _ if count < 1e6 => format!("{} k instructions", number::significant(count / 1e3, 2)),
        _ => format!("{} M instructions", number::significant(count / 1e6, 2)),
    });
    let parts: Vec<String> = time.into_iter().chain(counted).collect();
    parts.join(", ")
}

/// A label followed by its unit in brackets, if it has a unit.
pub(crate) fn with_unit(label: &str, unit: &str) -> String {
    if unit.is_empty() {
        label.to_owned()
    } else {
        format!("{label} ({unit})")
    }
}
