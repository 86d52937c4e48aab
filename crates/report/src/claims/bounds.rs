//! Bounds that the numbers of a claim must meet, and helpers that format these numbers and compute their range or mean.

use super::row::Row;
use palpate_study::number;

/// A bound on a number. If a number differs from a limit of the bound only by rounding errors, it counts as equal to
/// the limit.
#[derive(Clone, Copy)]
pub(super) enum Bound {
    AtLeast(f64),
    AtMost(f64),
    Above(f64),
    Below(f64),
    Between(f64, f64),
}

pub(super) const fn is(value: f64) -> Bound {
    Bound::Between(value, value)
}

/// Whether two numbers are equal, except for rounding errors: they differ by at most 10⁻⁹ of the smaller absolute
/// value.
pub(super) fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().min(b.abs())
}

/// Returns a test of a table row. A row passes the test if `number(row)` is a number that meets `bound`.
pub(super) fn within(
    number: impl Fn(&Row<'_>) -> Option<f64>,
    bound: Bound,
) -> impl Fn(&Row<'_>) -> bool {
    move |row| number(row).is_some_and(|number| bound.holds(number))
}

impl Bound {
    pub(super) fn holds(self, value: f64) -> bool {
        match self {
            Self::AtLeast(limit) => value >= limit || near(value, limit),
            Self::AtMost(limit) => value <= limit || near(value, limit),
            Self::Above(limit) => value > limit && !near(value, limit),
            Self::Below(limit) => value < limit && !near(value, limit),
            Self::Between(low, high) => {
                Self::AtLeast(low).holds(value) && Self::AtMost(high).holds(value)
            }
        }
    }

    pub(super) fn limit(self) -> Option<f64> {
        match self {
            Self::AtLeast(limit) | Self::AtMost(limit) => Some(limit),
            _ => None,
        }
    }

    pub(super) fn words(self, show: fn(f64) -> String) -> String {
        match self {
            Self::AtLeast(limit) => format!("at least {}", show(limit)),
            Self::AtMost(limit) => format!("at most {}", show(limit)),
            Self::Above(limit) => format!("more than {}", show(limit)),
            Self::Below(limit) => format!("less than {}", show(limit)),
            Self::Between(low, high) => span((low, high), show),
        }
    }
}

pub(super) fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

pub(super) fn short(value: f64) -> String {
    number::significant(value, 3)
}

/// The text `low to high`, with both numbers formatted by `show`. If both texts are equal, only one of them is
/// returned.
pub(super) fn span((low, high): (f64, f64), show: fn(f64) -> String) -> String {
    match (show(low), show(high)) {
        (low, high) if low == high => low,
        (low, high) => format!("{low} to {high}"),
    }
}

pub(super) fn range(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values.into_iter().fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((value.min(low), value.max(high))),
    })
}

pub(super) fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

pub(super) fn greatest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

pub(super) fn geometric_mean(values: &[f64]) -> f64 {
    let sum: f64 = values.iter().map(|value| libm::log(*value)).sum();
    libm::exp(sum / values.len() as f64)
}
