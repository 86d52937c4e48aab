//! Computes the reported estimate of a fit to displacements, including the correction of its bias.

use super::problem::{BASELINE, GAIN, Problem};
use crate::least_squares::LeastSquares;
use crate::outcome::{OfReadings, outcome};
use crate::unknowns::{CURVATURE, OTHERS, Square, State, Sums, UNKNOWNS, Unknowns};
use crate::{Estimated, GoodnessOfFit, Interval, PressError, PressEstimate};

impl Problem<'_> {
    /// The reported estimate, computed from the minimum of chi-squared. `limit` is half the width of a 95 % interval in
    /// standard errors.
    pub(super) fn outcome(
        &self,
        (state, sums): (&State, &Sums),
        covariance: &Square,
        interval: Interval,
        limit: f64,
    ) -> Result<PressEstimate, PressError> {
        let curvature = libm::exp(state.log_curvature);
        let unbiased = without_bias(curvature, relative_bias(self, state, covariance), interval);
        let std = covariance[(CURVATURE, CURVATURE)].sqrt();
        let nuisance = |index: usize| {
            let value = state.others[index - OTHERS];
            let is_fitted = self.fitted.sought[index];
            is_fitted.then(|| Estimated::normal(value, covariance[(index, index)].sqrt(), limit))
        };
        let window = self.fit.window.unwrap_or(f64::INFINITY);
        let is_wrong =
            |&marker: &usize| !self.kept[marker] && self.sight(state, marker).distance <= window;
        let readings = OfReadings {
            relative_curvature: Estimated {
                value: unbiased,
                std: curvature * std * (unbiased / curvature),
                interval,
            },
            baseline: nuisance(BASELINE),
            gain: nuisance(GAIN),
            wrong_markers: (0..self.kept.len()).filter(is_wrong).collect(),
            normal_std: self.normal_std,
            tangential_std: self.uses_tangential().then_some(self.tangential_std),
            r_squared: self.r_squared(state)?,
            goodness: self.goodness(sums),
        };
        outcome(self, (state, sums), covariance, limit, readings)
    }

    pub(super) fn goodness(&self, sums: &Sums) -> Option<GoodnessOfFit> {
        self.knows_noise()
            .then(|| GoodnessOfFit::new(sums.chi_squared, self.freedom()))
    }

    fn r_squared(&self, state: &State) -> Result<f64, PressError> {
        let contact = self.contact(state)?;
        let moved = self.displacements(&contact, state);
        let pairs = || {
            let read = self.reading.normal.iter().zip(&moved).zip(&self.kept);
            read.filter(|(_, kept)| **kept)
                .map(|((read, moved), _)| (*read, moved.normal))
        };
        let count = pairs().count().max(1) as f64;
        let mean = pairs().map(|(read, _)| read).sum::<f64>() / count;
        let (left, all) = pairs().fold((0.0, 0.0), |(left, all), (read, moved)| {
            (left + (read - moved).powi(2), all + (read - mean).powi(2))
        });
        Ok(if all > 0.0 { 1.0 - left / all } else { 0.0 })
    }
}

/// The estimated curvature, corrected for its relative bias `bias` and limited to its interval. The correction is not
/// valid if `bias` is above 1: the estimated effective radius is then less than about one standard error. In this case,
/// the result is the curvature for an effective radius of two standard errors.
fn without_bias(curvature: f64, bias: f64, interval: Interval) -> f64 {
    let corrected = if bias > 1.0 {
        curvature / (2.0 * bias.sqrt())
    } else if bias > 0.0 {
        curvature / (1.0 + bias)
    } else {
        curvature * (1.0 - bias)
    };
    let corrected = interval.low.map_or(corrected, |low| corrected.max(low));
    interval.high.map_or(corrected, |high| corrected.min(high))
}

/// Step of the fit parameters, in their standard errors, for second differences of the model.
const STEP: f64 = 0.3;

/// Relative bias of the estimated relative curvature, to first order. It is the bias of the logarithm of the curvature
/// (Box 1971) plus half of the logarithm's variance. It is positive if the curvature is overestimated on average.
///
/// The readings are nearly linear in the radius, not in the curvature. The distribution of the estimated curvature
/// therefore has a long tail towards sharp objects. If the variance is large, or if the second differences would need
/// impossible presses, the result is the variance of the logarithm. This is the relative bias of 1/x for a normally
/// distributed x.
fn relative_bias(problem: &Problem<'_>, state: &State, covariance: &Square) -> f64 {
    let variance = covariance[(CURVATURE, CURVATURE)];
    match bias(problem, state, covariance) {
        Ok(bias) if bias[CURVATURE].is_finite() && variance < 1.0 => {
            bias[CURVATURE] + 0.5 * variance
        }
        _ => variance,
    }
}

/// Bias of the fit parameters: −½ C Jᵀ d, where C is the covariance matrix of the fit parameters. J contains the first
/// derivatives of the model. d is the sum of the model's second derivatives along the columns of the Cholesky factor of
/// C.
fn bias(problem: &Problem<'_>, state: &State, covariance: &Square) -> Result<Unknowns, PressError> {
    let factor = covariance.cholesky().ok_or(PressError::OutOfRange)?;
    let middle = problem.residuals_of_all(state)?;
    let mut bends = vec![[0.0; 3]; middle.len()];
    for index in (0..UNKNOWNS).filter(|&index| problem.fitted.sought[index]) {
        let step = factor.l_dirty().column(index) * STEP;
        let step = Unknowns::from_fn(|row, _| if row < index { 0.0 } else { step[row] });
        let ahead = problem.residuals_of_all(&problem.stepped(state, &step))?;
        let behind = problem.residuals_of_all(&problem.stepped(state, &-step))?;
        for (marker, bend) in bends.iter_mut().enumerate() {
            for part in 0..3 {
                // `second` is the second difference of the model, not of the residuals. A residual is the reading minus
                // the model, hence the opposite sign.
                let second =
                    2.0 * middle[marker][part] - ahead[marker][part] - behind[marker][part];
                bend[part] += second / (STEP * STEP);
            }
        }
    }
    Ok(-0.5 * (covariance * problem.projected(state, &bends)?))
}
