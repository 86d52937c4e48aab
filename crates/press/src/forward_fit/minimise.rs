//! Levenberg and Marquardt's method.

use super::problem::{Problem, State, Sums, UNKNOWNS, Unknowns};
use crate::PressError;
use crate::definite::solve;

/// Least decrease of chi-squared that a further step must promise, of a fit that is to be exact.
pub(super) const EXACTLY: f64 = 1e-8;
const MOST_STEPS: usize = 200;
/// Smallest step that is worth taking, as a share of the unknowns.
const SMALLEST_STEP: f64 = 1e-13;
const MOST_DAMPING: f64 = 1e12;

/// The least sum of squares near a start, found when the next step promises to lower it by less than `enough`; that
/// step is taken, and the sums are those that it promises. One unknown may be held where it is.
///
/// # Errors
/// Where the start itself is out of range.
pub(super) fn minimise(
    problem: &Problem<'_>,
    start: State,
    enough: f64,
    held: Option<usize>,
) -> Result<(State, Sums), PressError> {
    let mut state = start;
    let mut sums = problem.sums(&state)?;
    let mut damping = 1e-3;
    for _ in 0..MOST_STEPS {
        let free = held.map_or(sums, |held| sums.holding(held));
        let Some(step) = damped_step(&free, damping) else {
            damping *= 10.0;
            if damping > MOST_DAMPING {
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
                if damping > MOST_DAMPING {
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
    (0..UNKNOWNS).all(|index| step[index].abs() <= SMALLEST_STEP * scale[index])
}

fn damped_step(sums: &Sums, damping: f64) -> Option<Unknowns> {
    let mut damped = sums.hessian;
    for index in 0..UNKNOWNS {
        damped[(index, index)] *= 1.0 + damping;
    }
    solve(&damped, &-sums.gradient)
}
