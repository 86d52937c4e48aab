//! Levenberg and Marquardt's method.

use super::problem::{Problem, State};
use crate::PressError;
use crate::unknowns::{Sums, UNKNOWNS, Unknowns};

/// Least predicted decrease of chi-squared for a further step of an exact fit.
pub(super) const EXACTLY: f64 = 1e-8;
const MAX_STEPS: usize = 200;
/// Smallest relevant step, relative to the unknowns.
const MIN_STEP: f64 = 1e-13;
const MAX_DAMPING: f64 = 1e12;

/// Finds the least chi-squared near a start. It stops if the predicted decrease of the next step is less than `enough`; then it
/// takes this step and returns its predicted sums. One unknown may be held constant.
///
/// # Errors
/// The error of the start, if no press has these values.
pub(super) fn minimise(
    problem: &Problem<'_>,
    start: State,
    enough: f64,
    held: Option<usize>,
) -> Result<(State, Sums), PressError> {
    let mut state = start;
    let mut sums = problem.sums(&state)?;
    let mut damping = 1e-3;
    for _ in 0..MAX_STEPS {
        let free = held.map_or(sums, |held| sums.holding(held));
        let Some(step) = free.damped_step(damping) else {
            damping *= 10.0;
            if damping > MAX_DAMPING {
                break;
            }
            continue;
        };
        let promised = sums.after(&step);
        let promise = sums.chi_squared - promised.chi_squared;
        let tried = problem.moved(&state, &step);
        if promise <= enough || is_small(&step, &state) {
            if problem.contact(&tried).is_ok() {
                (state, sums) = (tried, promised);
            }
            break;
        }
        match problem.sums(&tried) {
            Ok(better) if better.chi_squared <= sums.chi_squared => {
                let gain = sums.chi_squared - better.chi_squared;
                state = tried;
                sums = better;
                if gain > 0.5 * promise {
                    damping *= 0.1;
                }
            }
            _ => {
                damping = damping.max(1e-6) * 10.0;
                if damping > MAX_DAMPING {
                    break;
                }
            }
        }
    }
    Ok((state, sums))
}

fn is_small(step: &Unknowns, state: &State) -> bool {
    let length = state.indentation;
    let scale = [1.0, length, length, length, length, 1.0];
    (0..UNKNOWNS).all(|index| step[index].abs() <= MIN_STEP * scale[index])
}
