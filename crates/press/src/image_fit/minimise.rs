//! Levenberg and Marquardt's method on pictures.

use super::law::State;
use super::problem::{Jacobian, Problem, Residuals, Sums, UNKNOWNS};
use super::view::View;
use crate::PressError;
use crate::definite::solve;

const MOST_STEPS: usize = 60;
const MOST_DAMPING: f64 = 1e9;

/// A state with all that was computed there.
#[derive(Clone)]
pub(super) struct Fitted {
    pub(super) state: State,
    pub(super) residuals: Residuals,
    pub(super) jacobian: Jacobian,
    pub(super) sums: Sums,
}

impl Fitted {
    pub(super) fn at<V: View>(problem: &Problem<'_, V>, state: State) -> Result<Self, PressError> {
        let residuals = problem.residuals(&state)?;
        let jacobian = problem.jacobian(&state, &residuals)?;
        let sums = problem.sums(&state, &residuals, &jacobian)?;
        Ok(Self {
            state,
            residuals,
            jacobian,
            sums,
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
        let tried = problem.residuals(&state).and_then(|residuals| {
            let cost = problem.cost(&state, &residuals)?;
            Ok((residuals, cost))
        });
        match tried {
            Ok((residuals, cost)) if cost <= best.sums.chi_squared => {
                let gain = best.sums.chi_squared - cost;
                // Slopes that foretell badly are made anew.
                frozen &= gain > 0.3 * promise;
                let jacobian = if frozen {
                    best.jacobian
                } else {
                    problem.jacobian(&state, &residuals)?
                };
                let sums = problem.sums(&state, &residuals, &jacobian)?;
                best = Fitted {
                    state,
                    residuals,
                    jacobian,
                    sums,
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
