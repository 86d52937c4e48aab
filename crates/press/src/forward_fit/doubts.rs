//! Tests of a fit against readings that contradict it: score tests.

use nalgebra::SMatrix;
use palpate_chance::{Explained, LEFT, least_likely};

use super::problem::{CURVATURE, INDENTATION, Problem, Square, State, UNKNOWNS, Unknowns, finite};
use super::reading::Reading;
use super::search::SINGULAR;
use super::settings::ForwardFit;
use crate::definite::inverse;
use crate::score::{BY_INDENTATION, Noise, Patterns, Products, Score, matters, patterns};
use crate::{Doubt, PressError, PressEstimate};

/// Noise that is found, as a share of the largest displacement, below which it may be rounding.
const ROUNDING: f64 = 1e-3;
/// Least number of equations beyond the unknowns by which noise that is found can be told from patterns.
const FEW: usize = 8;

impl ForwardFit {
    /// Ways in which readings contradict the model, of an estimate that this fit made of them; none for a Gaussian, which
    /// is no body, and where there are hardly more equations than unknowns. Where the residuals are larger than the stated
    /// noise makes them, the other ways are judged by the residuals, not by this noise.
    ///
    /// # Errors
    /// Errors of [`ForwardFit::estimate`], and [`PressError::OutOfRange`] where the estimate is none of this fit.
    pub fn doubts(
        &self,
        reading: &Reading<'_>,
        estimate: &PressEstimate,
    ) -> Result<Vec<Doubt>, PressError> {
        self.validate(reading)?;
        if self.body.is_approximate() {
            return Ok(Vec::new());
        }
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
        match Test::new(&problem, &state)? {
            // Patterns are sought about the best of all fits, which a press that is not seen is not.
            Some(test) if estimate.is_seen => test.doubts(estimate),
            _ => {
                let large = large(estimate);
                let is_large = large.p_value() < Doubt::LEVEL;
                Ok(is_large.then_some(large).into_iter().collect())
            }
        }
    }
}

fn large(estimate: &PressEstimate) -> Doubt {
    Doubt::LargeResiduals {
        p_value: estimate.goodness.map_or(1.0, |goodness| goodness.p_value),
    }
}

/// A fit with all that its tests ask for.
struct Test<'p, 'a> {
    problem: &'p Problem<'a>,
    state: &'p State,
    covariance: Square,
    gradient: Unknowns,
    chi_squared: f64,
    freedom: usize,
}

impl<'p, 'a> Test<'p, 'a> {
    /// The tests of a fit; `None` where there is nothing to be tested.
    fn new(problem: &'p Problem<'a>, state: &'p State) -> Result<Option<Self>, PressError> {
        let freedom = problem.equations().saturating_sub(problem.unknowns());
        let largest = problem.reading.normal.iter();
        let largest = largest.fold(0.0, |most: f64, one| most.max(one.abs()));
        let is_rounding = !problem.knows_noise() && problem.normal_std <= ROUNDING * largest;
        if freedom < FEW || is_rounding {
            return Ok(None);
        }
        let sums = problem.sums(state)?;
        Ok(inverse(&sums.hessian, SINGULAR).map(|covariance| Self {
            problem,
            state,
            covariance,
            gradient: sums.gradient,
            chi_squared: sums.chi_squared,
            freedom,
        }))
    }

    fn doubts(self, estimate: &PressEstimate) -> Result<Vec<Doubt>, PressError> {
        let found = Noise::Found {
            chi_squared: self.chi_squared,
            freedom: self.freedom,
        };
        let noise = estimate.goodness.map_or(found, Noise::stated_or_found);
        let score = Score::new(&self.products()?, &self.covariance, &self.gradient, noise);
        let slipped = self.slipped(&score.noise)?;
        Ok(score.doubts(
            self.indentation(&score.noise),
            slipped,
            large(estimate).p_value(),
        ))
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
                products.by_slopes += self.sought(slopes) * patterns.transpose();
                products.by_patterns += *patterns * patterns.transpose();
                products.by_residuals += *patterns * residual;
            }
        }
        let sum =
            products.by_slopes.sum() + products.by_patterns.sum() + products.by_residuals.sum();
        finite(sum)?;
        Ok(products)
    }

    /// Slopes by the unknowns that were fitted.
    fn sought(&self, slopes: &Unknowns) -> Unknowns {
        Unknowns::from_fn(|unknown, _| match self.problem.sought[unknown] {
            true => slopes[unknown],
            false => 0.0,
        })
    }

    /// Probability by chance of a given indentation as far from the one that the displacements tell, where it was fitted
    /// too; `None` where it was not.
    fn indentation(&self, noise: &Noise) -> Option<f64> {
        let told = self.problem.reading.indentation?;
        let off = self.state.indentation - told.value;
        let variance = self.covariance[(INDENTATION, INDENTATION)];
        self.problem.sought[INDENTATION]
            .then(|| noise.of_indentation(off, told.std * told.std, variance))
    }

    /// Marker that contradicts the others most, of those that matter, and the probability that chance makes one do as much.
    fn slipped(&self, noise: &Noise) -> Result<(usize, f64), PressError> {
        let (problem, state) = (self.problem, self.state);
        let contact = problem.contact(state)?;
        let components = if problem.uses_tangential() { 3 } else { 1 };
        let slopes = problem.slopes(state)?;
        let variance = self.covariance[(CURVATURE, CURVATURE)];
        let chance = |(marker, slopes): (usize, [Unknowns; 3])| {
            let residuals = problem.residuals_at(&contact, state, marker);
            let (mut square, mut moves) = (0.0, 0.0);
            for (residual, slopes) in residuals.iter().zip(&slopes) {
                let slopes = self.sought(slopes);
                let by = self.covariance * slopes;
                square += residual * residual / (1.0 - slopes.dot(&by)).max(LEFT);
                moves += by[CURVATURE] * by[CURVATURE];
            }
            let explained = Explained {
                fall: square,
                freedom: components,
            };
            matters(moves, variance).then(|| (marker, noise.chance(explained)))
        };
        let counting = problem.counting().zip(slopes);
        Ok(least_likely(counting.filter_map(chance)))
    }
}
