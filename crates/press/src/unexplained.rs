//! Readings that no contact explains.

use palpate_statistics::chi_squared_tail;

use crate::PressError;

/// Probability of chance below which markers moved.
const MOVED: f64 = 1e-6;

/// Refusal of readings that a contact explains only so much better than none does, by each marker's chi-squared against rest on so
/// many readings: of another body where the markers moved, but for the one that moved most, which may be wrong.
pub(crate) fn unexplained(
    (improvement, needed): (f64, f64),
    squares: impl Iterator<Item = f64>,
    each: usize,
) -> PressError {
    let mut squares: Vec<f64> = squares.collect();
    squares.sort_by(|one, other| other.total_cmp(one));
    let others = squares.get(1..).unwrap_or_default();
    let (chi_squared, freedom) = (others.iter().sum(), each * others.len());
    let second = others.first().copied().unwrap_or(0.0);
    // Of all markers as many as two may have moved.
    let two = squares.len().max(1) as f64 * chi_squared_tail(second, each);
    match chi_squared_tail(chi_squared, freedom).min(two * two) < MOVED {
        true => PressError::OtherBody {
            chi_squared,
            freedom,
        },
        false => PressError::NoContact {
            improvement,
            needed,
        },
    }
}
