//! Numbers as text, and numbers that summarise several others.

use palpate_study::number;

/// A share in percent, with three significant digits.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

/// A number with three significant digits.
pub(super) fn short(value: f64) -> String {
    number::significant(value, 3)
}

/// `low to high`, formatted by `show`, or one number if both give the same text.
pub(super) fn span((low, high): (f64, f64), show: fn(f64) -> String) -> String {
    match (show(low), show(high)) {
        (low, high) if low == high => low,
        (low, high) => format!("{low} to {high}"),
    }
}

/// The smallest and largest of some numbers.
pub(super) fn range(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values.into_iter().fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((value.min(low), value.max(high))),
    })
}

/// Smallest of some numbers.
pub(super) fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Greatest of some numbers.
pub(super) fn greatest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// Geometric mean of positive numbers.
pub(super) fn geometric_mean(values: &[f64]) -> f64 {
    let sum: f64 = values.iter().map(|value| libm::log(*value)).sum();
    libm::exp(sum / values.len() as f64)
}
