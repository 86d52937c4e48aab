//! The posterior of the relative curvature: its interval by profile likelihood, and its mean.
//!
//! The pictures are not linear in the random departures of the sensor from its nominal parameters. Products of uncertain
//! depths and colours therefore shift the most likely curvature from the mean over all possible sensors. By Laplace's method,
//! the mean is the mode − ½ C ∇ ln det H, with the Hessian H of half of chi-squared by all unknowns, and its inverse C
//! (Tierney, Kass and Kadane 1989, to the same order).

use super::disc_displacements::State;
use super::fit_state::{FitState, minimise};
use super::image_problem::Problem;
use super::view::View;
use crate::Interval;
use crate::cholesky::inverse;
use crate::unknowns::{CURVATURE, INDENTATION, Square, Unknowns};

/// Relative tolerance of the square root of chi-squared's increase at the end of an interval.
const TOLERANCE: f64 = 0.02;
/// Least predicted decrease of chi-squared for a further step.
const ENOUGH: f64 = 1e-3;
const MAX_TRIES: usize = 24;
/// Largest distance of the logarithm of the curvature from its estimate in the search.
const MAX_LOG_RATIO: f64 = 7.0;

/// Step of the curvature, in its standard deviations; the other unknowns follow it.
const STEP: f64 = 0.3;
/// Variance of the logarithm of the curvature above which the pictures determine only its order of magnitude.
const MAX_VARIANCE: f64 = 1.0;
/// Largest distance of the mean from the mode, in standard deviations, for which the expansion is valid.
const MAX_SHIFT: f64 = 1.0;

/// The interval in which chi-squared, minimised over all other unknowns, is less than `limit` squared above its minimum. The
/// error is a state with a smaller chi-squared than the supposed best one.
pub(super) fn profile<V: View>(
    problem: &Problem<'_, V>,
    best: &FitState,
    std: f64,
    limit: f64,
) -> Result<Interval, State> {
    let mut ends = [None; 2];
    for (end, sign) in ends.iter_mut().zip([-1.0, 1.0]) {
        *end = walk(problem, best, std, limit, sign)?.map(libm::exp);
    }
    let [low, high] = ends;
    Ok(Interval { low, high })
}

fn walk<V: View>(
    problem: &Problem<'_, V>,
    best: &FitState,
    std: f64,
    limit: f64,
    sign: f64,
) -> Result<Option<f64>, State> {
    let mut from = (best.clone(), best.sums.ridge(), 0.0);
    let mut at = |step: f64| -> Option<Result<f64, State>> {
        let way = from.1 * (sign * (step - from.2));
        let mut start = problem.stepped(&from.0.state, &way);
        // The indentation is extrapolated as a power of the curvature.
        start.indentation =
            from.0.state.indentation * libm::exp(way[INDENTATION] / from.0.state.indentation);
        let is_near = way[CURVATURE].abs() < 0.3;
        let start = if is_near {
            let residuals = problem.residuals(&start).ok()?;
            from.0.clone().near(problem, start, residuals).ok()?
        } else {
            FitState::at(problem, start).ok()?
        };
        let found = minimise(problem, start, ENOUGH, Some(CURVATURE), is_near).ok()?;
        let rise = found.sums.chi_squared - best.sums.chi_squared;
        if rise < -0.05 {
            return Some(Err(found.state));
        }
        let along = found.sums.ridge();
        from = (found, along, step);
        Some(Ok(rise.max(0.0).sqrt()))
    };
    let mut step = (limit * std).clamp(1e-12, 1.0);
    let mut inside = (0.0, 0.0);
    let mut outside: Option<(f64, f64)> = None;
    for _ in 0..MAX_TRIES {
        match at(step) {
            Some(Err(state)) => return Err(state),
            Some(Ok(root)) => {
                if (root - limit).abs() <= TOLERANCE * limit {
                    let end = if root > 0.0 {
                        step * limit / root
                    } else {
                        step
                    };
                    return Ok(Some(best.state.log_curvature + sign * end));
                }
                if root < limit {
                    inside = (step, root);
                } else {
                    outside = Some((step, root));
                }
            }
            // No press is possible there.
            None => outside = Some((step, f64::INFINITY)),
        }
        step = match outside {
            Some((far, root)) if root.is_finite() => {
                let share = (limit - inside.1) / (root - inside.1);
                inside.0 + (far - inside.0) * share.clamp(0.05, 0.95)
            }
            Some((far, _)) => {
                if far - inside.0 < 0.02 * far || far < 1e-6 {
                    return Ok(None);
                }
                0.5 * (inside.0 + far)
            }
            None if inside.0 >= MAX_LOG_RATIO => return Ok(None),
            None => {
                let linear = inside.0 * limit / inside.1.max(0.1 * limit);
                linear
                    .clamp(1.05 * inside.0, 4.0 * inside.0)
                    .min(MAX_LOG_RATIO)
            }
        };
    }
    Ok(match outside {
        Some((far, root)) if root.is_finite() => Some(best.state.log_curvature + sign * far),
        _ => None,
    })
}

impl<V: View + Clone> Problem<'_, V> {
    /// Distance of the mean of the logarithm of the curvature from its most likely value, computed at the state where the weights
    /// were computed; 0 if it cannot be computed.
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

    /// Logarithm of the determinant after a step of the unknowns, with the sensor that fits best there.
    fn stepped_aside(&self, weighed: &FitState, step: &Unknowns) -> Option<f64> {
        let moved = &weighed.slopes.jacobian * step;
        let mut sensor = self.updated_sensor(&(&weighed.residuals - moved)).ok()?;
        // The sensor of the weights moves by the same departures as the most likely sensor.
        sensor.shift(&self.sensor, &self.updated_sensor(&weighed.residuals).ok()?);
        let state: State = self.stepped(&weighed.state, step);
        let mut there = self.clone();
        if !there.linearise_at(sensor) {
            return None;
        }
        let fitted = there.weigh(&state).ok()?;
        there.log_determinant(&fitted)
    }

    /// Logarithm of the determinant of the Hessian by all unknowns, except for a constant, at the state of the weights.
    fn log_determinant(&self, fitted: &FitState) -> Option<f64> {
        let of_press = inverse(&fitted.sums.hessian, 0.0)?.determinant();
        let mut sum = 2.0 * self.root.diagonal().map(libm::log).sum() - libm::log(of_press);
        for (&marker, whiten) in self.counting.iter().zip(&self.whiten) {
            sum -= 2.0 * whiten.diagonal().map(libm::log).sum();
            let spread = self.rest.local[marker].as_ref()?.spread.determinant();
            // Aligned discs have no unknown misalignment.
            if spread > 0.0 {
                sum -= libm::log(spread);
            }
        }
        Some(sum)
    }
}
