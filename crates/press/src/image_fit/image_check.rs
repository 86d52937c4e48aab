//! Score tests of a fit of images: do the images contradict its model? They include the departures common to all markers.

use nalgebra::{DMatrix, DVector, Matrix4, SMatrix, Vector4};
use palpate_statistics::{Explained, LEFT, least_likely};

use super::disc_displacements::State;
use super::fit_state::FitState;
use super::image_problem::{Jacobian, Problem};
use super::image_search::{SINGULAR, settle};
use super::view::{NUMBERS, Seen, View};
use super::{ImageFit, Rest};
use crate::cholesky::inverse;
use crate::score::{BY_INDENTATION, Noise, PATTERNS, Patterns, Products, Score, matters, patterns};
use crate::unknowns::{CURVATURE, INDENTATION, Square, UNKNOWNS};
use crate::{Doubt, GoodnessOfFit, Measured, PressError, PressEstimate};

impl<V: View + Clone> ImageFit<V> {
    /// Tests an estimate of this fit, and returns the ways in which the images contradict the model. Each pattern is one of the
    /// displacements of both discs, projected to the image. If the residuals are too large for the stated errors, the other
    /// tests use the residuals instead.
    ///
    /// # Errors
    /// Errors of [`ImageFit::estimate`].
    pub fn doubts(
        &self,
        rest: &Rest,
        seen: &[Option<Seen>],
        indentation: Option<Measured>,
        estimate: &PressEstimate,
    ) -> Result<Vec<Doubt>, PressError> {
        self.check(rest, seen, indentation)?;
        let mut problem = Problem::new(self, rest, seen, indentation)?;
        problem.leave_out(&estimate.wrong_markers);
        let Some(goodness) = estimate.goodness else {
            return Ok(Vec::new());
        };
        if problem.equations() <= problem.unknowns() {
            return Ok(Doubt::of_size(estimate.goodness));
        }
        let state = State::new(
            estimate.most_likely_curvature,
            self.markers.skin().place(estimate.contact),
            estimate.indentation.value,
        );
        let best = settle(&mut problem, state)?;
        match Test::new(&problem, &best) {
            Some(test) => test.doubts(goodness),
            None => Ok(Doubt::of_size(estimate.goodness)),
        }
    }
}

/// A fit with the values that its tests need.
struct Test<'p, 'a, V> {
    problem: &'p Problem<'a, V>,
    best: &'p FitState,
    covariance: Square,
}

impl<'p, 'a, V: View> Test<'p, 'a, V> {
    /// The tests of a fit; `None` if it does not determine some combination of its unknowns.
    fn new(problem: &'p Problem<'a, V>, best: &'p FitState) -> Option<Self> {
        let covariance = inverse(&best.sums.hessian, SINGULAR)?;
        Some(Self {
            problem,
            best,
            covariance,
        })
    }

    fn doubts(&self, goodness: GoodnessOfFit) -> Result<Vec<Doubt>, PressError> {
        let noise = Noise::stated_or_found(goodness);
        let gradient = &self.best.sums.gradient;
        let score = Score::new(&self.products()?, &self.covariance, gradient, noise);
        let slipped = self.slipped(&score.noise)?;
        let indentation = score.noise.indentation(
            self.problem.indentation,
            self.problem.sought[INDENTATION],
            self.best.state.indentation,
            self.covariance[(INDENTATION, INDENTATION)],
        );
        Ok(score.doubts(indentation, slipped, goodness.p_value))
    }

    fn products(&self) -> Result<Products<UNKNOWNS>, PressError> {
        let FitState {
            residuals, slopes, ..
        } = self.best;
        let patterns = self.patterns()?;
        let problem = self.problem;
        let common = problem.shared(&patterns)?;
        let by_slopes = slopes.jacobian.tr_mul(&patterns) - slopes.shared.tr_mul(&common);
        let by_patterns = patterns.tr_mul(&patterns) - common.tr_mul(&common);
        let by_residuals = patterns.tr_mul(residuals) - common.tr_mul(&problem.shared(residuals)?);
        Ok(Products {
            by_slopes: SMatrix::from_fn(|row, column| by_slopes[(row, column)]),
            by_patterns: SMatrix::from_fn(|row, column| by_patterns[(row, column)]),
            by_residuals: Patterns::from_fn(|row, _| by_residuals[row]),
        })
    }

    /// Patterns of the whitened pictures, one column each.
    fn patterns(&self) -> Result<DMatrix<f64>, PressError> {
        let Self { problem, best, .. } = self;
        let fit = problem.fit;
        let slopes = problem.by_displacements(&problem.displaced(&best.state)?)?;
        let moving = fit.moving(&best.state)?;
        let mut all = DMatrix::zeros(problem.equations(), PATTERNS);
        for (disc, body) in fit.bodies.iter().enumerate() {
            let contact = fit.contact(body, &best.state)?;
            let markers = problem.counting.iter().zip(&problem.whiten);
            for (at, (&marker, whiten)) in markers.enumerate() {
                let place = &fit.markers.places()[marker];
                let sight = fit.markers.sight(&best.state.place, place);
                let mut of_disc: SMatrix<f64, 3, PATTERNS> = SMatrix::zeros();
                for (component, pattern) in patterns(&contact, &sight).iter().enumerate() {
                    of_disc.set_row(component, &pattern.transpose());
                }
                if problem.indentation.is_some() && !problem.sought[INDENTATION] {
                    let by_indentation = moving.slopes[marker][disc].column(INDENTATION);
                    of_disc.set_column(BY_INDENTATION, &by_indentation);
                }
                let mut rows = all.fixed_rows_mut::<NUMBERS>(NUMBERS * at);
                rows += whiten * (slopes.displacements[marker][disc] * of_disc);
            }
        }
        Ok(all)
    }

    /// The marker that contradicts the others most, among those that can change the curvature, and its p-value among all of
    /// these markers.
    fn slipped(&self, noise: &Noise) -> Result<(usize, f64), PressError> {
        let FitState {
            residuals, slopes, ..
        } = self.best;
        let problem = self.problem;
        let shared = problem
            .root
            .solve_lower_triangular(&problem.common.transpose());
        let shared = shared.ok_or(PressError::OutOfRange)?;
        let of_residuals: DVector<f64> = problem.own(residuals)?;
        let of_slopes: Jacobian = &slopes.jacobian - shared.tr_mul(&slopes.shared);
        let variance = self.covariance[(CURVATURE, CURVATURE)];
        let chance = |(at, &marker): (usize, &usize)| {
            let first = NUMBERS * at;
            let score: Vector4<f64> = of_residuals.fixed_rows::<NUMBERS>(first).into();
            let slopes: SMatrix<f64, NUMBERS, UNKNOWNS> =
                of_slopes.fixed_rows::<NUMBERS>(first).into();
            let common = shared.fixed_columns::<NUMBERS>(first);
            let by = slopes * self.covariance;
            let taken = by * slopes.transpose() + common.tr_mul(&common);
            let left = Matrix4::identity() - taken;
            let eigen = left.symmetric_eigen();
            let pairs = eigen
                .eigenvalues
                .iter()
                .zip(eigen.eigenvectors.column_iter());
            let parts = pairs.map(|(value, along)| along.dot(&score).powi(2) / value.max(LEFT));
            let explained = Explained {
                fall: parts.sum(),
                freedom: NUMBERS,
            };
            let moves = by.column(CURVATURE).norm_squared();
            matters(moves, variance).then(|| (marker, noise.chance(explained)))
        };
        let counting = problem.counting.iter().enumerate();
        Ok(least_likely(counting.filter_map(chance)))
    }
}
