//! A state of a fit of images with its residuals and slopes, and the search for the minimum by Levenberg and Marquardt's
//! method.

use super::disc_displacements::State;
use super::image_problem::{Problem, Residuals, Slopes};
use super::view::View;
use crate::PressError;
use crate::cholesky::solve;
use crate::unknowns::Sums;

/// Least predicted decrease of chi-squared far from a minimum: four standard deviations.
const STUCK: f64 = 16.0;

const MAX_STEPS: usize = 60;
const MAX_DAMPING: f64 = 1e9;

/// A state with its residuals and slopes.
#[derive(Clone)]
pub(super) struct FitState {
    pub(super) state: State,
    pub(super) residuals: Residuals,
    pub(super) slopes: Slopes,
    /// Norm of the slope of each used marker's whitened picture by an inward displacement of both discs.
    pub(super) normal_slopes: Vec<f64>,
    pub(super) sums: Sums,
}

impl FitState {
    pub(super) fn at<V: View>(problem: &Problem<'_, V>, state: State) -> Result<Self, PressError> {
        problem.reached(problem.tried(state)?)
    }

    /// A nearby state with the same slopes.
    pub(super) fn near<V: View>(
        self,
        problem: &Problem<'_, V>,
        state: State,
        residuals: Residuals,
    ) -> Result<Self, PressError> {
        Ok(Self {
            sums: problem.sums(&state, &residuals, &self.slopes)?,
            state,
            residuals,
            ..self
        })
    }

    /// Standard deviation of the normal displacement of both discs of a marker by its own picture: the median of the used
    /// markers.
    pub(super) fn normal_std(&self) -> f64 {
        let mut stds: Vec<f64> = self
            .normal_slopes
            .iter()
            .map(|slope| slope.recip())
            .collect();
        stds.sort_by(f64::total_cmp);
        stds.get(stds.len() / 2).copied().unwrap_or(f64::INFINITY)
    }

    /// Predicted decrease of chi-squared by an undamped step; 0 if there is no such step.
    pub(super) fn promise(&self) -> f64 {
        let gradient = self.sums.gradient;
        solve(&self.sums.hessian, &gradient).map_or(0.0, |step| gradient.dot(&step))
    }

    /// Whether the search ended far from a minimum, for example at a limit of possible presses: an undamped step is predicted to
    /// remove most of chi-squared.
    pub(super) fn is_stuck(&self) -> bool {
        self.promise() > (0.5 * self.sums.chi_squared).max(STUCK)
    }
}

/// Finds the least chi-squared near a start. It stops if the predicted decrease of the next step is less than `enough`. One
/// unknown may be held constant. With `frozen`, the slopes of the start are used as long as their predictions are good; else
/// they are computed at each step.
///
/// # Errors
/// The error of the start, if no press has these values.
pub(super) fn minimise<V: View>(
    problem: &Problem<'_, V>,
    start: FitState,
    enough: f64,
    held: Option<usize>,
    frozen: bool,
) -> Result<FitState, PressError> {
    let mut best = start;
    let mut frozen = frozen;
    let mut damping = if frozen { 0.0 } else { 1e-3 };
    for _ in 0..MAX_STEPS {
        let free = held.map_or(best.sums, |held| best.sums.holding(held));
        let Some(step) = free.damped_step(damping) else {
            damping = damping.max(1e-6) * 10.0;
            if damping > MAX_DAMPING {
                break;
            }
            continue;
        };
        let promise = -2.0 * free.gradient.dot(&step) - step.dot(&(free.hessian * step));
        if promise <= enough {
            break;
        }
        let state = problem.stepped(&best.state, &step);
        match problem.tried(state) {
            Ok(tried) if tried.cost <= best.sums.chi_squared => {
                let gain = best.sums.chi_squared - tried.cost;
                // Recompute slopes with bad predictions, and keep those with good ones.
                frozen = match frozen {
                    true => gain > 0.3 * promise,
                    false => (gain - promise).abs() < 0.2 * promise,
                };
                best = if frozen {
                    best.near(problem, state, tried.residuals)?
                } else {
                    problem.reached(tried)?
                };
                if gain > 0.5 * promise {
                    damping *= 0.1;
                }
            }
            _ if frozen => {
                frozen = false;
                best = FitState::at(problem, best.state)?;
            }
            _ => {
                damping = damping.max(1e-6) * 10.0;
                if damping > MAX_DAMPING {
                    break;
                }
            }
        }
    }
    Ok(best)
}
