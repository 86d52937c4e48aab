//! Computes the posterior mean of the relative curvature.
//!
//! The images of the markers are not linear in the random deviations of the sensor from its nominal parameters.
//! Therefore the most likely curvature (the mode) differs from the mean over all possible sensors. By Laplace's method,
//! the mean of the fit parameters is mode − ½ C ∇ ln det H (equivalent to Tierney, Kass and Kadane 1989). H is the
//! Hessian of half of chi-squared with respect to all fit parameters, and C is the inverse of H.

use super::fit_state::FitState;
use super::image_problem::Problem;
use crate::least_squares::{LeastSquares, inverse};
use crate::unknowns::{CURVATURE, Square, State, Unknowns};

/// Step of the logarithm of the curvature for a numerical derivative, in standard errors. The other fit parameters
/// follow the step such that chi-squared stays minimal.
const STEP: f64 = 0.3;
/// Largest variance of the logarithm of the curvature for which the posterior mean of the curvature is computed. If the
/// variance is larger, the images only determine the order of magnitude of the curvature.
const MAX_VARIANCE: f64 = 1.0;
/// Largest difference between mean and mode of the curvature, in standard errors, for which the formula of the mean is
/// used. For larger differences, the expansion is not valid.
const MAX_SHIFT: f64 = 1.0;

impl Problem<'_> {
    /// Posterior mean of the logarithm of the curvature, minus the most likely value of this logarithm. The result is 0
    /// if the mean cannot be computed. `weighed` is the fit for which the weights of the readings were computed.
    pub(super) fn mean_beside(&self, weighed: &FitState, covariance: &Square) -> f64 {
        let variance = covariance[(CURVATURE, CURVATURE)];
        let std = variance.sqrt();
        if variance >= MAX_VARIANCE {
            return 0.0;
        }
        let along = covariance.column(CURVATURE) / std;
        let slope = || {
            let aside = self.stepped_aside(weighed, &(along * STEP))?;
            Some((aside - self.log_determinant(weighed)?) / STEP)
        };
        let beside = -0.5 * slope().unwrap_or(0.0);
        match beside.is_finite() {
            true => std * beside.clamp(-MAX_SHIFT, MAX_SHIFT),
            false => 0.0,
        }
    }

    /// Value of [`Self::log_determinant`] after the step `step` of the fit parameters. The sensor's parameters are
    /// changed to the values that fit best after this step. The result is `None` if the determinant cannot be computed.
    fn stepped_aside(&self, weighed: &FitState, step: &Unknowns) -> Option<f64> {
        let moved = &weighed.slopes.jacobian * step;
        let mut sensor = self.updated_sensor(&(&weighed.residuals - moved)).ok()?;
        // The caller compares the determinant after the step with the determinant at `self.sensor`. The parameters in
        // `self.sensor` differ slightly from those that fit best before the step. Therefore add to `self.sensor` only
        // the change of the best-fitting parameters that the step causes.
        sensor.shift(&self.sensor, &self.updated_sensor(&weighed.residuals).ok()?);
        let state: State = self.stepped(&weighed.state, step);
        let mut there = self.clone();
        if !there.linearise_at(sensor) {
            return None;
        }
        let fitted = there.weigh(&state).ok()?;
        there.log_determinant(&fitted)
    }

    /// Logarithm of the determinant of the Hessian with respect to all fit parameters, without an additive constant.
    /// `fitted` must be the fit for which the weights of the readings were computed. The result is `None` if the
    /// Hessian is singular.
    fn log_determinant(&self, fitted: &FitState) -> Option<f64> {
        let of_press = inverse(&fitted.sums.hessian, 0.0)?.determinant();
        let mut sum = 2.0 * self.root.diagonal().map(libm::log).sum() - libm::log(of_press);
        for (&marker, whiten) in self.counting.iter().zip(&self.whiten) {
            sum -= 2.0 * whiten.diagonal().map(libm::log).sum();
            let spread = self.rest.local[marker].as_ref()?.spread.determinant();
            // If the discs are aligned, the misalignment is not fitted, and the determinant of its covariance is 0.
            if spread > 0.0 {
                sum -= libm::log(spread);
            }
        }
        Some(sum)
    }
}
