//! The error for readings without a detected contact.

use palpate_statistics::chi_squared_tail;

use crate::PressError;

/// Significance level of the test of whether the markers moved.
const SIGNIFICANCE_LEVEL: f64 = 1e-6;

/// Returns the error for a press without a detected contact, in which the fitted contact decreases chi-squared by
/// `improvement`, which is less than `needed`. The error is [`PressError::OtherBody`] if the markers moved
/// significantly, otherwise [`PressError::NoContact`]. `squares` contains one value per marker: chi-squared of the
/// hypothesis that the marker did not move. Each value is a sum over `each` readings. The marker that moved most is
/// ignored in this test, because it may be an outlier.
pub(crate) fn no_contact(
    (improvement, needed): (f64, f64),
    squares: impl Iterator<Item = f64>,
    each: usize,
) -> PressError {
    let mut squares: Vec<f64> = squares.collect();
    squares.sort_by(|one, other| other.total_cmp(one));
    let others = squares.get(1..).unwrap_or_default();
    let (chi_squared, freedom) = (others.iter().sum(), each * others.len());
    let second = others.first().copied().unwrap_or(0.0);
    // `two` is the p-value of the marker that moved second most. It is multiplied by the number of markers, because
    // this marker was chosen among all markers.
    let two = squares.len().max(1) as f64 * chi_squared_tail(second, each);
    match chi_squared_tail(chi_squared, freedom).min(two * two) < SIGNIFICANCE_LEVEL {
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
