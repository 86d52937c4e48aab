//! Readings that no contact explains.

use palpate_chance::chi_squared_tail;

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
    let (mut sum, mut most, mut markers) = (0.0, 0.0_f64, 0_usize);
    for square in squares {
        (sum, most, markers) = (sum + square, most.max(square), markers + 1);
    }
    let (chi_squared, freedom) = (sum - most, each * markers.saturating_sub(1));
    match chi_squared_tail(chi_squared, freedom) < MOVED {
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
