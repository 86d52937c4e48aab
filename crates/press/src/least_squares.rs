//! Nonlinear least squares by the Levenberg–Marquardt method. It is used for fits of displacements and for fits of
//! images.

use nalgebra::{SMatrix, SVector};

use crate::unknowns::{Fitted, Square, State, Sums, UNKNOWNS, Unknowns};
use crate::{Body, Contact, PressError, Skin};

/// The least-squares problem of a press: readings, fit parameters and their priors.
pub(crate) trait LeastSquares {
    /// Values of the fit parameters, with chi-squared and its derivatives at these values.
    type Fit: Clone;
    /// Threshold for a singular information matrix. The matrix is scaled such that its diagonal is 1, and its Cholesky
    /// factor is computed. The matrix is inverted only if the smallest diagonal entry of this factor exceeds the
    /// threshold.
    const SINGULAR: f64;
    /// Text for the error message if the information matrix is singular. It names the quantities that the readings do
    /// not determine.
    const FREE: &'static str;
    /// A fit with a fixed curvature stops if the next step is predicted to decrease chi-squared by less than this
    /// value.
    const ENOUGH_OF_PROFILE: f64;

    fn state_of(fit: &Self::Fit) -> &State;

    fn sums_of(fit: &Self::Fit) -> &Sums;

    fn press(&self) -> (&Skin, &Body);

    fn fitted(&self) -> &Fitted;

    /// Two numbers: the number of markers that the fit uses, and the number of equations per marker.
    fn used(&self) -> [usize; 2];

    fn estimates_noise(&self) -> bool {
        false
    }

    fn contact(&self, state: &State) -> Result<Contact<'_>, PressError> {
        let (skin, body) = self.press();
        state.contact(skin, body)
    }

    fn equations(&self) -> usize {
        let [markers, each] = self.used();
        markers * each
    }

    /// Degrees of freedom of chi-squared: the number of equations and priors, minus the number of fitted parameters.
    fn freedom(&self) -> usize {
        let fitted = self.fitted();
        (self.equations() + fitted.priors().count()).saturating_sub(fitted.count())
    }

    /// Returns an error if there are too few markers to determine the fit parameters. If the noise is estimated, one
    /// more equation is necessary.
    ///
    /// # Errors
    /// [`PressError::TooFewMarkers`].
    fn determined(&self) -> Result<(), PressError> {
        let needed = self.fitted().count() + usize::from(self.estimates_noise());
        let equations = self.equations();
        if equations >= needed {
            return Ok(());
        }
        Err(PressError::TooFewMarkers {
            markers: self.used()[0],
            equations,
            needed,
        })
    }

    fn covariance(&self, sums: &Sums) -> Result<Square, PressError> {
        let free = PressError::Undetermined { what: Self::FREE };
        inverse(&sums.hessian, Self::SINGULAR).ok_or(free)
    }

    fn damping(_fit: &Self::Fit) -> f64 {
        1e-3
    }

    fn stepped(&self, state: &State, step: &Unknowns) -> State;

    /// The fit, with its derivatives, for the fit parameters `state`.
    ///
    /// # Errors
    /// [`PressError`] if no press has these fit parameters.
    fn fit_at(&self, state: State) -> Result<Self::Fit, PressError>;

    /// Tries a step of the fit parameters. Returns the fit after the step, or `None` if the step increases chi-squared.
    /// `promise` is the predicted decrease of chi-squared.
    fn advance(
        &self,
        from: &Self::Fit,
        step: &Unknowns,
        promise: f64,
    ) -> Result<Option<Self::Fit>, PressError>;

    /// Computes the derivatives of the model again at the parameters of the fit. Returns `None` if the derivatives
    /// already belong to these parameters.
    fn refreshed(&self, _fit: &Self::Fit) -> Result<Option<Self::Fit>, PressError> {
        Ok(None)
    }

    /// The fit after the last, very small step of a search. A quadratic approximation predicts chi-squared and its
    /// derivatives, which saves their computation. By default, the last step is omitted, and the result is `None`.
    fn last_step(&self, _from: &Self::Fit, _step: &Unknowns) -> Option<Self::Fit> {
        None
    }

    /// The fit for the fit parameters `state`, which may reuse parts of the similar fit `_fit`. The logarithms of the
    /// two fits' curvatures differ by `_step`.
    fn fit_near(
        &self,
        _fit: &Self::Fit,
        state: State,
        _step: f64,
    ) -> Result<Self::Fit, PressError> {
        self.fit_at(state)
    }

    /// Whether `fit` has a clearly smaller chi-squared than `best`, the best fit so far.
    fn is_better(&self, fit: &Self::Fit, best: &Self::Fit) -> bool;
}

/// A search for the exact minimum stops if the next step is predicted to decrease chi-squared by less than this value.
pub(crate) const EXACTLY: f64 = 1e-8;
const MAX_STEPS: usize = 200;
const MIN_STEP: f64 = 1e-13;
const MAX_DAMPING: f64 = 1e12;

/// Finds the minimum of chi-squared near the fit `start`. The search stops if the next step is predicted to decrease
/// chi-squared by less than `enough`. If `held` is the index of a fit parameter, this parameter is held constant.
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

/// Solves the system `matrix` · x = `right`. Returns `None` if the matrix is not positive definite or x is not finite.
pub(crate) fn solve<const N: usize>(
    matrix: &SMatrix<f64, N, N>,
    right: &SVector<f64, N>,
) -> Option<SVector<f64, N>> {
    let scale = scale(matrix)?;
    let scaled = matrix.component_mul(&(scale * scale.transpose()));
    let factor = scaled.cholesky()?;
    let solution = factor
        .solve(&right.component_mul(&scale))
        .component_mul(&scale);
    solution
        .iter()
        .all(|entry| entry.is_finite())
        .then_some(solution)
}

/// Inverse of a matrix. The matrix is first scaled such that its diagonal is 1. The result is `None` if the smallest
/// diagonal entry of the Cholesky factor of the scaled matrix is at most `singular`.
pub(crate) fn inverse<const N: usize>(
    matrix: &SMatrix<f64, N, N>,
    singular: f64,
) -> Option<SMatrix<f64, N, N>> {
    let scale = scale(matrix)?;
    let outer = scale * scale.transpose();
    let factor = matrix.component_mul(&outer).cholesky()?;
    let lower = factor.l_dirty();
    let least = (0..N)
        .map(|index| lower[(index, index)])
        .fold(f64::INFINITY, f64::min);
    (least > singular).then(|| factor.inverse().component_mul(&outer))
}

/// Factors by which the rows and the columns of a matrix must be multiplied so that its diagonal becomes 1; `None` if a
/// diagonal entry is not positive.
fn scale<const N: usize>(matrix: &SMatrix<f64, N, N>) -> Option<SVector<f64, N>> {
    let scale = SVector::<f64, N>::from_fn(|index, _| matrix[(index, index)].sqrt().recip());
    scale.iter().all(|entry| entry.is_finite()).then_some(scale)
}
