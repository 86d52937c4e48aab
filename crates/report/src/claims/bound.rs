//! Bounds on numbers.

use super::numbers::span;
use super::row::Row;

/// Bound on a number; numbers within rounding of a limit count as equal to it.
#[derive(Clone, Copy)]
pub(super) enum Bound {
    AtLeast(f64),
    AtMost(f64),
    Above(f64),
    Below(f64),
    Between(f64, f64),
}

/// Bound that accepts only `value`, up to rounding.
pub(super) const fn is(value: f64) -> Bound {
    Bound::Between(value, value)
}

/// Whether two numbers are equal up to the rounding of decimal text.
pub(super) fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().min(b.abs())
}

/// Whether a number of a row is within a bound.
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

    /// The limit of `AtLeast` or `AtMost`; none for other bounds.
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
