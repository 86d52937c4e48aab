//! Means and standard deviations of inverse quantities, such as radii. They are defined only if the inverted quantity
//! is not near 0.

use palpate_study::Quantity;
use palpate_sweep::Summary;

/// Smallest distance of the inverted quantity from 0, in standard deviations, for which means and standard deviations
/// are reported. If the estimates are Gaussian, one in 30,000 then has the wrong sign.
const MIN_DEVIATIONS: f64 = 4.0;

/// Removes means and standard deviations of inverse quantities, such as radii, if the trials do not determine the sign
/// of the inverted quantity. The inverse of a Gaussian number has no mean and no standard deviation: a computed mean
/// would depend on the few trials nearest to 0. Quantiles of inverse quantities are kept, because they are defined.
pub fn drop_undefined_moments(quantities: &[Quantity], summaries: &mut [Summary]) {
    for (place, quantity) in quantities.iter().enumerate() {
        let Some(inverted) = quantity.inverse_of(quantities) else {
            continue;
        };
        let Summary { mean, std, .. } = summaries[inverted];
        let std = std.unwrap_or(0.0);
        if mean.is_some_and(|mean| mean.abs() >= MIN_DEVIATIONS * std) {
            continue;
        }
        summaries[place] = Summary {
            mean: None,
            std: None,
            bias: None,
            rms_error: None,
            rms_error_std: None,
            mean_abs_error: None,
            relative_rms_error: None,
            relative_mean_abs_error: None,
            mean_reported_std: None,
            ..summaries[place]
        };
    }
}
