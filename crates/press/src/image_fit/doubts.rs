//! Tests of a fit against pictures that contradict it: score tests, in which what is common to all markers takes part.

use nalgebra::{DMatrix, DVector, Matrix4, SMatrix, Vector4};
use palpate_statistics::{Explained, LEFT, least_likely};

use super::fitted::Fitted;
use super::law::State;
use super::outcome::{SINGULAR, settle};
use super::problem::Problem;
use super::rest::Rest;
use super::settings::ImageFit;
use super::unknowns::{CURVATURE, INDENTATION, Jacobian, Square, UNKNOWNS};
use super::view::{NUMBERS, Seen, View};
use crate::definite::inverse;
use crate::score::{BY_INDENTATION, Noise, PATTERNS, Patterns, Products, Score, matters, patterns};
use crate::{Doubt, GoodnessOfFit, Measured, PressError, PressEstimate};

impl<V: View + Clone> ImageFit<V> {
    /// Ways in which pictures contradict the model, of an estimate that this fit made of them: each pattern is one of the
    /// displacements of both discs, as the camera sees it. Where the residuals are larger than the stated errors make them,
    /// the other ways are judged by the residuals, not by these errors.
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
        let state = State {
            log_curvature: libm::log(estimate.most_likely_curvature),
            place: self.markers.skin().place(estimate.contact),
            indentation: estimate.indentation.value,
            shift: [0.0; 2],
        };
        let best = settle(&mut problem, state)?;
        match Test::new(&problem, &best) {
            Some(test) => test.doubts(goodness),
            None => Ok(Doubt::of_size(estimate.goodness)),
        }
    }
}

/// A fit with all that its tests ask for.
struct Test<'p, 'a, V> {
    problem: &'p Problem<'a, V>,
    best: &'p Fitted,
    covariance: Square,
}

impl<'p, 'a, V: View> Test<'p, 'a, V> {
    /// The tests of a fit; `None` where some combination of its unknowns is free.
    fn new(problem: &'p Problem<'a, V>, best: &'p Fitted) -> Option<Self> {
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
        Ok(score.doubts(self.indentation(&score.noise), slipped, goodness.p_value))
    }

    fn products(&self) -> Result<Products<UNKNOWNS>, PressError> {
        let Fitted {
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

    /// Patterns of the whitened pictures, a column each.
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

    /// Probability by chance of a given indentation as far from the one that the pictures tell, where it was fitted too;
    /// `None` where it was not.
    fn indentation(&self, noise: &Noise) -> Option<f64> {
        let told = self.problem.indentation?;
        let off = self.best.state.indentation - told.value;
        let variance = self.covariance[(INDENTATION, INDENTATION)];
        self.problem.sought[INDENTATION]
            .then(|| noise.of_indentation(off, told.std * told.std, variance))
    }

    /// Marker that contradicts the others most, of those that matter, and the probability that chance makes one do as much.
    fn slipped(&self, noise: &Noise) -> Result<(usize, f64), PressError> {
        let Fitted {
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
