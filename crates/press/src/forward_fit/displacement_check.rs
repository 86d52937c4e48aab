//! Score tests of a fit: do the displacements contradict its model?

use nalgebra::SMatrix;

use super::problem::{Problem, State, finite};
use super::search::SINGULAR;
use super::{ForwardFit, Reading};
use crate::cholesky::inverse;
use crate::score::{BY_INDENTATION, Noise, Patterns, Products, Score, patterns};
use crate::unknowns::{INDENTATION, Square, UNKNOWNS, Unknowns};
use crate::{Doubt, PressError, PressEstimate};

impl ForwardFit {
    /// Tests an estimate of this fit, and returns the ways in which the readings contradict the model. There are none for a
    /// Gaussian, which is only an approximation, or if there are hardly more equations than unknowns. If the residuals are too
    /// large for the stated noise, the other tests use the residuals instead.
    ///
    /// # Errors
    /// Errors of [`ForwardFit::estimate`], and [`PressError::OutOfRange`] if the estimate is not from this fit.
    pub fn doubts(
        &self,
        reading: &Reading<'_>,
        estimate: &PressEstimate,
    ) -> Result<Vec<Doubt>, PressError> {
        self.validate(reading)?;
        let mut problem = Problem::new(self, reading);
        let skin = reading.markers.skin();
        let place = problem.place_at(skin.place(estimate.contact).direction.as_ref());
        let state = State {
            log_curvature: libm::log(estimate.most_likely_curvature),
            place,
            indentation: estimate.indentation.value,
            baseline: estimate.baseline.map_or(0.0, |baseline| baseline.value),
            gain: estimate.gain.map_or(1.0, |gain| gain.value),
        };
        problem.keep_window(&state);
        for &marker in &estimate.wrong_markers {
            if let Some(kept) = problem.kept.get_mut(marker) {
                *kept = false;
            }
        }
        problem.normal_std = estimate.normal_std;
        problem.tangential_std = estimate.tangential_std.unwrap_or(problem.tangential_std);
        let large = estimate.goodness.map_or(1.0, |goodness| goodness.p_value);
        match Test::new(&problem, &state)? {
            // The tests are valid only at the best fit, which an undetected contact is not.
            Some(test) if estimate.is_detected => test.doubts(large),
            _ => Ok(Doubt::of_size(estimate.goodness)),
        }
    }
}

/// A fit with the values that its tests need.
struct Test<'p, 'a> {
    problem: &'p Problem<'a>,
    state: &'p State,
    covariance: Square,
    gradient: Unknowns,
    noise: Noise,
}

impl<'p, 'a> Test<'p, 'a> {
    /// The tests of a fit; `None` if it cannot be tested.
    fn new(problem: &'p Problem<'a>, state: &'p State) -> Result<Option<Self>, PressError> {
        let sums = problem.sums(state)?;
        let noise = problem.noise(&sums);
        let testable = noise.zip(inverse(&sums.hessian, SINGULAR));
        Ok(testable.map(|(noise, covariance)| Self {
            problem,
            state,
            covariance,
            gradient: sums.gradient,
            noise,
        }))
    }

    fn doubts(&self, large: f64) -> Result<Vec<Doubt>, PressError> {
        let (problem, state) = (self.problem, self.state);
        let slipped = problem.slipped(state, &self.covariance, &self.noise)?;
        let doubts = self.beside(slipped, large)?;
        let is_less_likely = |doubt: &Doubt| doubt.p_value() < slipped.1;
        if slipped.1 < Doubt::LEVEL
            && !doubts.iter().any(is_less_likely)
            && let Some((others, state, _)) = problem.without(slipped.0, state)
            && let Some(test) = Test::new(&others, &state)?
        {
            // A pattern that the outlier explains is not evidence of another body.
            return test.beside(slipped, large);
        }
        Ok(doubts)
    }

    /// Doubts from the markers that are used, and from a marker that may be an outlier.
    fn beside(&self, slipped: (usize, f64), large: f64) -> Result<Vec<Doubt>, PressError> {
        let products = self.products()?;
        let score = Score::new(&products, &self.covariance, &self.gradient, self.noise);
        let indentation = self.noise.indentation(
            self.problem.reading.indentation,
            self.problem.sought[INDENTATION],
            self.state.indentation,
            self.covariance[(INDENTATION, INDENTATION)],
        );
        Ok(score.doubts(indentation, slipped, large))
    }

    fn products(&self) -> Result<Products<UNKNOWNS>, PressError> {
        let (problem, state) = (self.problem, self.state);
        let contact = problem.contact(state)?;
        let is_given = problem.reading.indentation.is_some() && !problem.sought[INDENTATION];
        let mut products = Products {
            by_slopes: SMatrix::zeros(),
            by_patterns: SMatrix::zeros(),
            by_residuals: Patterns::zeros(),
        };
        let slopes = problem.slopes(state)?;
        for (marker, slopes) in problem.counting().zip(slopes) {
            let sight = problem.sight(state, marker);
            let [normal, x, y] = patterns(&contact, &sight);
            let mut patterns = [
                normal / problem.normal_std,
                Patterns::zeros(),
                Patterns::zeros(),
            ];
            if problem.uses_tangential() {
                patterns[1] = x / problem.tangential_std;
                patterns[2] = y / problem.tangential_std;
            }
            let residuals = problem.residuals_at(&contact, state, marker);
            for ((patterns, slopes), residual) in patterns.iter_mut().zip(&slopes).zip(residuals) {
                if is_given {
                    patterns[BY_INDENTATION] = slopes[INDENTATION];
                }
                products.by_slopes += problem.of_sought(slopes) * patterns.transpose();
                products.by_patterns += *patterns * patterns.transpose();
                products.by_residuals += *patterns * residual;
            }
        }
        let sum =
            products.by_slopes.sum() + products.by_patterns.sum() + products.by_residuals.sum();
        finite(sum)?;
        Ok(products)
    }
}
