//! Range of numbers with which surfaces compute.

use std::ops::RangeInclusive;

/// Lengths and slopes whose squares neither overflow nor vanish. Beyond them directions are lost.
pub(crate) const SQUARABLE: RangeInclusive<f64> = 1e-150..=1e150;

/// Whether a place is near enough to be moved and squared; no place that is NaN or infinite is.
pub(crate) fn is_within_reach(x: f64, y: f64) -> bool {
    x.abs() + y.abs() <= *SQUARABLE.end()
}
