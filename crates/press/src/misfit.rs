//! Tests whether a press was fitted with the wrong model. Patterns in the residuals show that the soft body differs
//! from the model or that the object is not round. Another test compares a stated indentation with the indentation that
//! is estimated from the readings.
//!
//! A pattern is a change of the markers' displacements. In Rao's score test, the amplitude of the pattern is treated as
//! an additional fit parameter, and the resulting decrease of chi-squared is computed to first order.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector2};
use palpate_statistics::{Explained, Misfit, SIGNIFICANCE_LEVEL, StatedQuantity};

use crate::markers::Sight;
use crate::unknowns::{Square, Sums, UNKNOWNS};
use crate::{Contact, Estimated, GoodnessOfFit, Measured, PressError};

pub(crate) const PATTERNS: usize = 7;
/// Indices of the patterns of displacements that depend only on the distance from the contact.
const BY_DISTANCE: Range<usize> = 0..5;
/// Indices of the patterns of displacements that also depend on the direction from the contact.
const BY_DIRECTION: Range<usize> = 5..7;

/// A pattern of displacements is tested only if changes of the fit parameters leave at least this share of the pattern
/// unexplained. A smaller remainder is mostly an effect of the model's nonlinearity.
const MIN_REMAINING_SHARE: f64 = 0.1;

/// Displacements of a marker in all tested patterns, one column per pattern. The three rows are the components of the
/// displacement: inward, and along both axes of the skin at the marker. The scale of a pattern is arbitrary.
pub(crate) type Patterns = SMatrix<f64, 3, PATTERNS>;

/// Displacements of a marker in the tested patterns. `contact` is the fitted contact, and `sight` the distance and
/// direction of the marker from this contact.
///
/// The displacement is u_z inward and u_r along the skin, and r is the distance from the contact. Five patterns show
/// that the body differs from the model. They are changes of the size, the steepness and the offset of u_z, and of the
/// size and the steepness of u_r. Two patterns show that the contact is elongated. The inward displacement then changes
/// approximately by r ∂u_z/∂r cos 2θ, where θ is the angle from the contact's longer axis. The displacements along the
/// skin change by the gradient of the potential r u_r cos 2θ.
pub(crate) fn patterns(contact: &Contact<'_>, sight: &Sight) -> Patterns {
    let field = contact.field(sight.distance);
    let steep = sight.distance * field.normal_per_r;
    let steep_radial = sight.distance * field.radial_per_r;
    let offset = contact.radius * contact.radius;
    let [x, y] = [sight.bearing.x, sight.bearing.y];
    let (cosine, sine) = (x * x - y * y, 2.0 * x * y);
    let inward = [
        field.normal,
        steep,
        offset,
        0.0,
        0.0,
        steep * cosine,
        steep * sine,
    ];
    let (along, across) = (field.radial + steep_radial, 2.0 * field.radial);
    let outward = [
        0.0,
        0.0,
        0.0,
        field.radial,
        steep_radial,
        along * cosine,
        along * sine,
    ];
    let around = [0.0, 0.0, 0.0, 0.0, 0.0, -across * sine, across * cosine];
    let turned = Vector2::new(-sight.outward.y, sight.outward.x);
    Patterns::from_fn(|component, pattern| match component {
        0 => inward[pattern],
        axis => sight.outward[axis - 1] * outward[pattern] + turned[axis - 1] * around[pattern],
    })
}

#[derive(Clone, Copy)]
pub(crate) enum Noise {
    Stated,
    /// Noise that is estimated from the residuals: chi-squared of the residuals, and its degrees of freedom.
    Found {
        chi_squared: f64,
        freedom: usize,
    },
}

impl Noise {
    /// Returns the stated noise or, if the residuals are significantly larger, the noise of the residuals. With a
    /// stated noise that is too small, the tests would report every pattern as significant.
    pub(crate) fn stated_or_found(goodness: GoodnessOfFit) -> Self {
        match goodness.is_poor() {
            true => Self::Found {
                chi_squared: goodness.chi_squared,
                freedom: goodness.freedom,
            },
            false => Self::Stated,
        }
    }

    /// P-value of `explained`, the decrease of chi-squared by patterns in the residuals. It is computed for readings
    /// with this noise.
    pub(crate) fn chance(&self, explained: Explained) -> f64 {
        match *self {
            Self::Stated => explained.p_value(None),
            Self::Found {
                chi_squared,
                freedom,
            } => explained.p_value(Some((chi_squared, freedom))),
        }
    }
}

/// Sums over the readings, in standard deviations: products of the patterns with the derivatives with respect to the
/// fit parameters (`by_slopes`), with each other (`by_patterns`), and with the residuals (`by_residuals`).
pub(crate) struct PatternSums {
    pub(crate) by_slopes: SMatrix<f64, UNKNOWNS, PATTERNS>,
    pub(crate) by_patterns: SMatrix<f64, PATTERNS, PATTERNS>,
    pub(crate) by_residuals: SVector<f64, PATTERNS>,
}

impl PatternSums {
    /// The significant patterns in the residuals of a fit. `sums` contains chi-squared of this fit and its derivatives,
    /// and `covariance` is the covariance of the fit parameters.
    pub(crate) fn misfits(
        &self,
        sums: &Sums,
        covariance: &Square,
        noise: &Noise,
    ) -> impl Iterator<Item = Misfit> + use<> {
        let p_value = |range| noise.chance(self.explained(range, sums, covariance));
        let other_body = Misfit::OtherBody {
            p_value: p_value(BY_DISTANCE),
        };
        let not_round = Misfit::NotRound {
            p_value: p_value(BY_DIRECTION),
        };
        let misfits = [other_body, not_round].into_iter();
        misfits.filter(|misfit| misfit.p_value() < SIGNIFICANCE_LEVEL)
    }

    /// Decrease of chi-squared, to first order, if the amplitudes of the patterns with the indices `range` were fitted
    /// too. At the best fit, the gradient of chi-squared is 0, unless a fit parameter is at the limit of its range. If
    /// the gradient is not 0, the part of the residuals that a change of the fit parameters could explain is removed
    /// (Neyman's C(α)).
    fn explained(&self, range: Range<usize>, sums: &Sums, covariance: &Square) -> Explained {
        let (by_slopes, by_patterns) = (&self.by_slopes, &self.by_patterns);
        let taken = by_slopes.transpose() * covariance;
        let residuals = self.by_residuals + taken * sums.gradient;
        let remaining = by_patterns - taken * by_slopes;
        let (first, count) = (range.start, range.len());
        let squares: Vec<f64> = range.map(|one| by_patterns[(one, one)]).collect();
        let remaining = DMatrix::from_fn(count, count, |row, column| {
            remaining[(first + row, first + column)]
        });
        let residuals = DVector::from_fn(count, |row, _| residuals[first + row]);
        Explained::by(&squares, &remaining, &residuals, MIN_REMAINING_SHARE)
    }
}

/// Returns a misfit if the stated indentation differs significantly from `alone`, the indentation that is estimated
/// from the other readings.
///
/// # Errors
/// [`PressError::Undetermined`] if the other readings do not determine the indentation.
pub(crate) fn stated_indentation(
    stated: Measured,
    alone: &Estimated,
    p_value: f64,
) -> Result<Option<Misfit>, PressError> {
    if !alone.std.is_finite() {
        return Err(PressError::Undetermined {
            what: "the displacements alone give no bound on the indentation",
        });
    }
    let misfit = Misfit::Stated {
        quantity: StatedQuantity::Indentation,
        stated: stated.value,
        estimated: alone.value,
        p_value,
    };
    Ok((p_value < SIGNIFICANCE_LEVEL).then_some(misfit))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scattered(number: usize) -> f64 {
        libm::sin(1.7 * (number * number) as f64 + 0.3)
    }

    #[test]
    fn residuals_beyond_a_limit_of_the_unknowns_are_no_pattern() {
        const READINGS: usize = 20;
        let slopes =
            SMatrix::<f64, READINGS, UNKNOWNS>::from_fn(|row, column| scattered(6 * row + column));
        let patterns = SMatrix::<f64, READINGS, PATTERNS>::from_fn(|row, column| {
            scattered(190 + 7 * row + column)
        });
        // If a fit parameter is at the limit of its range, some residuals remain that only a change beyond the limit
        // would explain. In this test, all residuals are of this kind, so they must not count as a pattern.
        let residuals = slopes * SVector::from([40.0, -70.0, 0.0, 0.0, 0.0, 0.0]);
        let products = PatternSums {
            by_slopes: slopes.tr_mul(&patterns),
            by_patterns: patterns.tr_mul(&patterns),
            by_residuals: patterns.tr_mul(&residuals),
        };
        let covariance = slopes.tr_mul(&slopes).try_inverse().unwrap();
        let mut sums = Sums {
            gradient: -slopes.tr_mul(&residuals),
            ..Sums::default()
        };
        let count = |sums: &Sums| products.misfits(sums, &covariance, &Noise::Stated).count();
        assert_eq!(count(&sums), 0);
        sums.gradient.fill(0.0);
        assert_eq!(count(&sums), 2);
    }

    #[test]
    fn a_stated_indentation_needs_a_bound() {
        let stated = Measured {
            value: 0.8,
            std: 0.03,
        };
        let code = |std, p_value| {
            let misfit = stated_indentation(stated, &Estimated::normal(1.0, std, 2.0), p_value);
            misfit.map(|misfit| misfit.map_or("", |misfit| misfit.code()))
        };
        assert_eq!(code(0.04, 0.006), Ok(""));
        assert_eq!(code(0.04, 0.004), Ok("stated-indentation"));
        let error = code(f64::INFINITY, 0.004).unwrap_err();
        assert_eq!(<&str>::from(error), "undetermined");
    }
}
