//! Estimates curvature from series of rolls.

use crate::roll_series::check;
use crate::{Places, RollSeries, SeriesError, SeriesEstimate, SeriesMethod, SeriesNoise};

/// The curvature from series of rolls of a probe of `radius`.
///
/// # Errors
/// [`SeriesError`] if a number is out of range, if a roll contradicts the others, or if the rolls do not determine the
/// curvature.
pub fn estimate_series(
    _method: SeriesMethod,
    radius: f64,
    places: &Places,
    noise: &SeriesNoise,
    rolls: &[RollSeries],
) -> Result<SeriesEstimate, SeriesError> {
    check(radius, places, noise, rolls)?;
    Err(SeriesError::TooFewRolls { rolls: 0 })
}
