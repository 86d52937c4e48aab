//! Statistics that an inverse has only where what it is the inverse of is not near 0.

use palpate_study::Quantity;
use palpate_sweep::Summary;

/// Standard deviations from 0 at which the mean of an inverse counts: one trial in 30,000 of Gaussian estimates is beyond.
const FAR: f64 = 4.0;

/// Takes away means and standard deviations of inverses, such as radii, of which the trials leave the sign undecided: the
/// inverse of a Gaussian number has no moments, so that they would tell of the few trials that came nearest to 0. Quantiles
/// stay.
pub(crate) fn withhold(quantities: &[Quantity], summaries: &mut [Summary]) {
    for (place, quantity) in quantities.iter().enumerate() {
        let Some(of) = quantity.inverse_of() else {
            continue;
        };
        let inverted = quantities.iter().position(|one| *one == of);
        let is_far = inverted.is_some_and(|inverted| {
            let Summary { mean, std, .. } = summaries[inverted];
            let std = std.unwrap_or(0.0);
            mean.is_some_and(|mean| mean.abs() >= FAR * std)
        });
        if is_far {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn withheld(mean: f64, std: Option<f64>) -> Summary {
        let all = |mean: f64, std: Option<f64>| Summary {
            observations: 9,
            mean: Some(mean),
            std,
            rms_error: Some(1.0),
            q50: Some(20.0),
            ..Summary::default()
        };
        let quantities = [Quantity::OBJECT_CURVATURE, Quantity::OBJECT_RADIUS];
        let mut summaries = [all(mean, std), all(2e4, Some(1e6))];
        let curvature = summaries[0];
        withhold(&quantities, &mut summaries);
        assert_eq!(summaries[0], curvature);
        summaries[1]
    }

    #[test]
    fn a_radius_near_flat_has_quantiles_and_no_mean() {
        for mean in [0.039, -0.039, 0.0] {
            let radius = withheld(mean, Some(0.01));
            assert_eq!(
                (radius.mean, radius.std, radius.rms_error),
                (None, None, None)
            );
            assert_eq!((radius.q50, radius.observations), (Some(20.0), 9));
        }
    }

    #[test]
    fn a_radius_of_a_known_sign_keeps_its_mean() {
        for (mean, std) in [
            (0.041, Some(0.01)),
            (-0.041, Some(0.01)),
            (0.05, Some(0.0)),
            (0.05, None),
        ] {
            assert_eq!(withheld(mean, std).mean, Some(2e4));
        }
    }
}
