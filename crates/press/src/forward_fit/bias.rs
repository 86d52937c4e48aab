//! The bias of least squares on a curved model.

use super::problem::{CURVATURE, Problem, Square, State, UNKNOWNS, Unknowns};
use crate::PressError;

/// Steps for second differences, in standard deviations.
const STEP: f64 = 0.3;

/// Relative bias of the estimated relative curvature, to first order: the bias of its logarithm (Box 1971) plus half
/// its variance. Positive where it is overestimated on average.
///
/// The readings are nearly linear in the radius and not in the curvature, whose estimate therefore has a long tail
/// towards sharp objects. Where the variance is large, or second differences leave the domain of presses, the bias is
/// that of 1/x for a normally distributed x.
pub(super) fn relative_bias(problem: &Problem<'_>, state: &State, covariance: &Square) -> f64 {
    let variance = covariance[(CURVATURE, CURVATURE)];
    match bias(problem, state, covariance) {
        Ok(bias) if bias[CURVATURE].is_finite() && variance < 1.0 => {
            bias[CURVATURE] + 0.5 * variance
        }
        _ => variance,
    }
}

/// −½ Σ Jᵀ d with d the second derivatives of the model along the axes of the covariance Σ.
fn bias(problem: &Problem<'_>, state: &State, covariance: &Square) -> Result<Unknowns, PressError> {
    let factor = covariance.cholesky().ok_or(PressError::OutOfRange)?;
    let middle = problem.residuals_of_all(state)?;
    let mut bends = vec![[0.0; 3]; middle.len()];
    for index in (0..UNKNOWNS).filter(|&index| problem.sought[index]) {
        let step = factor.l_dirty().column(index) * STEP;
        let step = Unknowns::from_fn(|row, _| if row < index { 0.0 } else { step[row] });
        let ahead = problem.residuals_of_all(&problem.moved(state, &step))?;
        let behind = problem.residuals_of_all(&problem.moved(state, &-step))?;
        for (marker, bend) in bends.iter_mut().enumerate() {
            for part in 0..3 {
                // Residuals fall where the model rises.
                let second =
                    2.0 * middle[marker][part] - ahead[marker][part] - behind[marker][part];
                bend[part] += second / (STEP * STEP);
            }
        }
    }
    Ok(-0.5 * (covariance * problem.projected(state, &bends)?))
}
