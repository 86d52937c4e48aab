//! Levenberg and Marquardt's method on pictures.

use super::fitted::Fitted;
use super::law::State;
use super::problem::Problem;
use super::unknowns::{Residuals, UNKNOWNS};
use super::view::View;
use crate::PressError;
use crate::definite::solve;

const MOST_STEPS: usize = 60;
const MOST_DAMPING: f64 = 1e9;

impl Fitted {
    pub(super) fn at<V: View>(problem: &Problem<'_, V>, state: State) -> Result<Self, PressError> {
        problem.reached(problem.tried(state)?)
    }

    /// Another state, near enough for these slopes to serve.
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
}

/// The least sum of squares near a start, found when the next step promises to lower it by less than `enough`. One
/// unknown may be held where it is. Slopes are those of the start while they serve (`frozen`), or of each step.
///
/// # Errors
/// Where the start itself is out of range.
pub(super) fn minimise<V: View>(
    problem: &Problem<'_, V>,
    start: Fitted,
    enough: f64,
    held: Option<usize>,
    frozen: bool,
) -> Result<Fitted, PressError> {
    let mut best = start;
    let mut frozen = frozen;
    let mut damping = if frozen { 0.0 } else { 1e-3 };
    for _ in 0..MOST_STEPS {
        let mut free = best.sums;
        if let Some(held) = held {
            free.hold(held);
        }
        let mut damped = free.hessian;
        for index in 0..UNKNOWNS {
            damped[(index, index)] *= 1.0 + damping;
        }
        let Some(step) = solve(&damped, &-free.gradient) else {
            damping = damping.max(1e-6) * 10.0;
            if damping > MOST_DAMPING {
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
                // Slopes that foretell badly are made anew, those that foretell well serve on.
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
                best = Fitted::at(problem, best.state)?;
            }
            _ => {
                damping = damping.max(1e-6) * 10.0;
                if damping > MOST_DAMPING {
                    break;
                }
            }
        }
    }
    Ok(best)
}
