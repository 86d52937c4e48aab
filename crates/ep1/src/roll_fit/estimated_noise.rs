//! Estimates the noise of contact points and of rotations from the residuals of a fit to rolls.

use nalgebra::{Matrix2, Matrix4, SMatrix, SVector, Vector2, Vector4};
use palpate_statistics::ratio_tail;

use super::{FitNoise, RollData, SeriesFit, inverse_of, moved};
use crate::rolled_path::LocalShape;

/// Smallest ratio of the standard deviation of contact points to the standard deviation of the rotation error that all
/// samples of a roll share. At this ratio, contact points determine the path far better than rotations do, so a smaller
/// ratio would give the same result.
pub(crate) const MIN_SHARE: f64 = 0.01;

/// One fit does not restrict the rotation errors that all samples of a roll share. This constant is the variance that
/// this fit assumes for them, divided by the variance with which the readings determine them.
const UNLIMITED: f64 = 1e8;

/// A fit with the weights that follow from the estimated noise is compared with a fit with equal weights. If the p-value of
/// their difference is below this value, the noise is of another kind than assumed, and the weights are not used.
const MIN_P_VALUE: f64 = 0.005;

/// Normal equations of the relative rotation error that the samples of a roll share. The position at the start of the
/// roll is eliminated from them.
#[derive(Clone, Debug)]
pub(super) struct SharedError<const N: usize> {
    pub(super) information: Matrix2<f64>,
    pub(super) mixed: SMatrix<f64, 2, N>,
    pub(super) gradient: Vector2<f64>,
}

/// Noise of contact points and rotations, estimated from the residuals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EstimatedNoise {
    /// Mean square of the residuals of a fit in which all contact points have the same weight.
    pub(crate) mean_square: f64,
    /// Variance of a contact point, in squared radii of the probe.
    pub(crate) variance: f64,
    /// Variance of the relative rotation error that the samples of a roll share.
    pub(crate) shared: f64,
    /// Degrees of freedom of `shared`.
    pub(crate) shared_freedom: f64,
    /// Degrees of freedom of the estimated noise in the covariance of the fit. The errors of the fit have Student's t
    /// distribution with these degrees of freedom.
    pub(crate) freedom: f64,
    /// `None` if the fit uses the weights that follow from the estimated noise. If these weights change the fit by more
    /// than its error, the fit uses equal weights, and this is the p-value of the change.
    pub(crate) misfit: Option<f64>,
}

impl<const N: usize> SeriesFit<N> {
    /// Like [`new`](Self::new), but if the noise is not stated, the weights follow from the estimated noise. The effect
    /// of these weights is computed to first order from a fit with equal weights. If this effect is too large for the
    /// noise, the result is the fit with equal weights.
    pub(crate) fn weighted(
        rolls: &[RollData],
        noise: &FitNoise,
        shape: LocalShape,
        tolerance: f64,
    ) -> Option<Self> {
        let mut fit = Self::new(rolls, noise, shape, tolerance)?;
        if !noise.is_estimated {
            return Some(fit);
        }
        let before = fit.covariance.trace();
        let mut estimated = fit.variances();
        let least = noise
            .min_variance
            .max(MIN_SHARE * MIN_SHARE * estimated.shared);
        estimated.variance = estimated.variance.max(least).max(f64::MIN_POSITIVE);
        let mut spread = fit.information * estimated.variance;
        for SharedError { mixed, .. } in fit.rolls.iter().map(|roll| &roll.shared) {
            spread += mixed.tr_mul(mixed) * estimated.shared;
        }
        let spread = fit.covariance * spread * fit.covariance;
        let mut equal = fit.clone();
        let full = fit.weigh(estimated.ratio())?;
        let square = full.dot(&(inverse_of(&spread)? * full));
        let freedom = estimated.shared_freedom;
        let p_value = ratio_tail(square, N, freedom, freedom as usize);
        if p_value < MIN_P_VALUE {
            equal.covariance = spread / estimated.variance;
            estimated.freedom = freedom;
            estimated.misfit = Some(p_value);
            equal.estimated = Some(estimated);
            return Some(equal);
        }
        let (shape, part) = moved(&fit.shape, &full)?;
        fit.shape = shape;
        for roll in &mut fit.rolls {
            roll.gradient -= roll.information * full * part;
            roll.shared.gradient -= roll.shared.mixed * full * part;
        }
        // Satterthwaite's approximation of the degrees of freedom of a sum of two variances.
        let share = 1.0 - (before / fit.covariance.trace()).min(1.0);
        let other = (1.0 - share) * (1.0 - share) / estimated.freedom;
        estimated.freedom = 1.0 / (share * share / estimated.shared_freedom + other);
        fit.estimated = Some(estimated);
        Some(fit)
    }

    /// Converts the normal equations of a fit with equal weights to the equations of a fit in which all samples of a
    /// roll share a rotation error. `ratio` is the variance of a shared error, divided by the variance of a contact
    /// point. Returns the change of the unknowns.
    fn weigh(&mut self, ratio: f64) -> Option<SVector<f64, N>> {
        let mut gradient = SVector::<f64, N>::zeros();
        self.information = SMatrix::zeros();
        for roll in &mut self.rolls {
            let share = roll.shared.share(ratio);
            let by_shared = roll.shared.mixed.tr_mul(&share);
            roll.information -= by_shared * roll.shared.mixed;
            roll.gradient -= by_shared * roll.shared.gradient;
            self.chi_squared -= roll.shared.gradient.dot(&(share * roll.shared.gradient));
            self.information += roll.information;
            gradient += roll.gradient;
        }
        self.covariance = inverse_of(&self.information)?;
        let step = self.covariance * gradient;
        self.chi_squared -= gradient.dot(&step);
        Some(step)
    }

    /// Estimates the variances of the noise from a fit in which all contact points have the same weight. The variance
    /// of a contact point follows from the residuals of a second fit, which hardly restricts the shared rotation
    /// errors. The variance of the shared errors follows from the gradients with respect to them: the expected sum of
    /// the squared gradients is a linear function of both variances.
    fn variances(&self) -> EstimatedNoise {
        let (mut square, mut first, mut second) = (0.0, 0.0, 0.0);
        let mut mixed = SMatrix::<f64, N, N>::zeros();
        let mut weighted = mixed;
        for SharedError {
            information,
            mixed: own,
            gradient,
        } in self.rolls.iter().map(|roll| &roll.shared)
        {
            square += gradient.norm_squared();
            first += information.trace();
            second += information.norm_squared();
            mixed += own.tr_mul(own);
            weighted += own.tr_mul(&(information * own));
        }
        let fitted = self.covariance * mixed;
        let freedom = self.freedom.max(1) as f64;
        first -= fitted.trace();
        second += (fitted * fitted).trace() - 2.0 * (self.covariance * weighted).trace();
        let mean_square = self.chi_squared / freedom;
        let mut unlimited = self.clone();
        let within = (self.freedom + 3).checked_sub(2 * self.rolls.len());
        let within = within.filter(|within| *within > 0 && second > 0.0);
        let variance = within.and_then(|within| {
            unlimited.weigh(UNLIMITED / first)?;
            Some(unlimited.chi_squared.max(0.0) / within as f64)
        });
        let shared = variance.map_or(0.0, |variance| (square - variance * first) / second);
        EstimatedNoise {
            mean_square,
            variance: variance.filter(|_| shared > 0.0).unwrap_or(mean_square),
            shared: shared.max(0.0),
            shared_freedom: (first * first / second).max(1.0),
            freedom,
            misfit: None,
        }
    }

    /// −2 times the logarithm of the likelihood for the estimated noise, up to a constant.
    pub(crate) fn deviance(&self, noise: &EstimatedNoise) -> f64 {
        let count = (self.freedom + N) as f64;
        let ratio = noise.ratio();
        let shared = self.rolls.iter().map(|roll| {
            let sum = Matrix2::identity() + roll.shared.information * ratio;
            libm::log(sum.determinant())
        });
        count * libm::log(noise.variance) + shared.sum::<f64>() + self.chi_squared / noise.variance
    }

    /// The part of chi-squared that is due to the rotation errors that all samples of a roll share.
    pub(crate) fn shared_chi_squared(&self) -> f64 {
        let ratio = self.estimated.map_or(0.0, |noise| noise.ratio());
        let of_rolls = self.rolls.iter().map(|roll| roll.shared.chi_squared(ratio));
        of_rolls.sum()
    }
}

impl EstimatedNoise {
    /// Variance of the shared rotation error, divided by the variance of a contact point.
    pub(super) fn ratio(&self) -> f64 {
        self.shared / self.variance
    }
}

impl<const N: usize> SharedError<N> {
    /// Posterior covariance of the shared rotation error of the roll. `ratio` is its prior variance, divided by the
    /// variance of a contact point.
    fn share(&self, ratio: f64) -> Matrix2<f64> {
        let sum = Matrix2::identity() + self.information * ratio;
        sum.try_inverse().unwrap_or_default() * ratio
    }

    /// The part of chi-squared that is due to the shared rotation error. `ratio` is the variance of this error, divided
    /// by the variance of a contact point.
    pub(super) fn chi_squared(&self, ratio: f64) -> f64 {
        let free = self.information.try_inverse().unwrap_or_default();
        self.gradient
            .dot(&((free - self.share(ratio)) * self.gradient))
    }

    /// Eliminates the position of the contact at the start of the roll from the normal equations. The remaining unknown
    /// is the rotation error that all samples of the roll share.
    pub(super) fn new(
        own: &Matrix4<f64>,
        mixed: &SMatrix<f64, 4, N>,
        gradient: &Vector4<f64>,
    ) -> Option<Self> {
        let of_start = own.fixed_view::<2, 2>(0, 0).try_inverse()?;
        let cross = own.fixed_view::<2, 2>(2, 0) * of_start;
        Some(Self {
            information: own.fixed_view::<2, 2>(2, 2) - cross * own.fixed_view::<2, 2>(0, 2),
            mixed: mixed.fixed_view::<2, N>(2, 0) - cross * mixed.fixed_view::<2, N>(0, 0),
            gradient: gradient.fixed_rows::<2>(2) - cross * gradient.fixed_rows::<2>(0),
        })
    }
}
