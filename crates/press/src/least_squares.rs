//! Nonlinear least squares by Levenberg and Marquardt's method.

use crate::PressError;
use crate::state::State;
use crate::unknowns::{Sums, UNKNOWNS, Unknowns};

/// A least-squares problem over the unknowns of a press.
pub(crate) trait LeastSquares {
    /// A state with chi-squared and its derivatives.
    type Fit: Clone;
    /// Least predicted decrease of chi-squared for a further step of a fit with a held curvature.
    const ENOUGH_OF_PROFILE: f64;

    fn state_of(fit: &Self::Fit) -> &State;

    fn sums_of(fit: &Self::Fit) -> &Sums;

    /// Damping of the first step.
    fn damping(_fit: &Self::Fit) -> f64 {
        1e-3
    }

    /// The state after a step.
    fn stepped(&self, state: &State, step: &Unknowns) -> State;

    /// The fit at a state.
    ///
    /// # Errors
    /// [`PressError`] if no press has these values.
    fn fit_at(&self, state: State) -> Result<Self::Fit, PressError>;

    /// The fit after a step that is predicted to decrease chi-squared by `promise`; `None` if chi-squared increases.
    fn advance(
        &self,
        from: &Self::Fit,
        step: &Unknowns,
        promise: f64,
    ) -> Result<Option<Self::Fit>, PressError>;

    /// The same fit with new slopes, if it has those of another state.
    fn refreshed(&self, _fit: &Self::Fit) -> Result<Option<Self::Fit>, PressError> {
        Ok(None)
    }

    /// The fit after the last step, whose sums are predicted, if it is taken.
    fn last_step(&self, _from: &Self::Fit, _step: &Unknowns) -> Option<Self::Fit> {
        None
    }

    /// The fit at a state whose logarithm of the curvature differs by `step` from that of another fit.
    fn fit_near(
        &self,
        _fit: &Self::Fit,
        state: State,
        _step: f64,
    ) -> Result<Self::Fit, PressError> {
        self.fit_at(state)
    }

    /// Whether a fit has a clearly smaller chi-squared than the supposed best one.
    fn is_better(&self, fit: &Self::Fit, best: &Self::Fit) -> bool;
}

/// An exact fit stops if the next step is predicted to decrease chi-squared by less than this.
pub(crate) const EXACTLY: f64 = 1e-8;
const MAX_STEPS: usize = 200;
/// Smallest relevant step, relative to the unknowns.
const MIN_STEP: f64 = 1e-13;
const MAX_DAMPING: f64 = 1e12;

/// Finds the least chi-squared near a start. It stops if the predicted decrease of the next step is less than `enough`. One
/// unknown may be held constant.
///
/// # Errors
/// [`PressError`] if the numbers are out of range.
pub(crate) fn minimise<P: LeastSquares>(
    problem: &P,
    start: P::Fit,
    enough: f64,
    held: Option<usize>,
) -> Result<P::Fit, PressError> {
    let mut damping = P::damping(&start);
    let mut best = start;
    for _ in 0..MAX_STEPS {
        let sums = P::sums_of(&best);
        let free = held.map_or(*sums, |held| sums.holding(held));
        let Some(step) = free.damped_step(damping) else {
            damping = damping.max(1e-6) * 10.0;
            if damping > MAX_DAMPING {
                break;
            }
            continue;
        };
        let chi_squared = sums.chi_squared;
        let promise = chi_squared - sums.after(&step).chi_squared;
        if promise <= enough || is_small(&step, P::state_of(&best)) {
            return Ok(problem.last_step(&best, &step).unwrap_or(best));
        }
        if let Some(better) = problem.advance(&best, &step, promise)? {
            best = better;
            if chi_squared - P::sums_of(&best).chi_squared > 0.5 * promise {
                damping *= 0.1;
            }
        } else if let Some(refreshed) = problem.refreshed(&best)? {
            best = refreshed;
        } else {
            damping = damping.max(1e-6) * 10.0;
            if damping > MAX_DAMPING {
                break;
            }
        }
    }
    Ok(best)
}

fn is_small(step: &Unknowns, state: &State) -> bool {
    let length = state.indentation;
    let scale = [1.0, length, length, length, length, 1.0];
    (0..UNKNOWNS).all(|index| step[index].abs() <= MIN_STEP * scale[index])
}
