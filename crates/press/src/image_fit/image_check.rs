//! Tests whether images of markers contradict the fitted model. The fitted model includes the deviations of the
//! sensor's parameters from their nominal values.

use nalgebra::{DMatrix, SMatrix};
use palpate_statistics::{Misfit, SIGNIFICANCE_LEVEL, chi_squared_tail, normal_tail};

use super::fit_state::FitState;
use super::image_problem::Problem;
use super::image_search::settle;
use super::view::{NUMBERS, Seen};
use super::{ImageFit, Rest};
use crate::least_squares::LeastSquares;
use crate::misfit::{Noise, PATTERNS, PatternSums, patterns, stated_indentation};
use crate::unknowns::State;
use crate::{Measured, PressError, PressEstimate};

impl ImageFit {
    /// Compares a stated indentation with the indentation that is estimated from the images alone.
    ///
    /// # Errors
    /// Returns an error if the images alone do not determine the indentation.
    pub fn check_indentation(
        &self,
        rest: &Rest,
        seen: &[Option<Seen>],
        indentation: Option<Measured>,
    ) -> Result<Option<Misfit>, PressError> {
        let Some(stated) = indentation else {
            return Ok(None);
        };
        let alone = self.estimate(rest, seen, None)?.indentation;
        let difference = (stated.value - alone.value).abs() / libm::hypot(stated.std, alone.std);
        stated_indentation(stated, &alone, 2.0 * normal_tail(difference))
    }

    /// Tests an estimate that this fit computed, and returns all contradictions between the images and the model. A
    /// stated indentation is tested separately by [`Self::check_indentation`]. If the residuals are too large for the
    /// stated errors, the tests for outliers and for patterns in the residuals use the noise of the residuals instead.
    ///
    /// # Errors
    /// Errors of [`ImageFit::estimate`].
    pub fn misfits(
        &self,
        rest: &Rest,
        seen: &[Option<Seen>],
        indentation: Option<Measured>,
        estimate: &PressEstimate,
    ) -> Result<Vec<Misfit>, PressError> {
        self.check(rest, seen, indentation)?;
        let mut problem = Problem::new(self, rest, seen, indentation)?;
        problem.leave_out(&estimate.wrong_markers);
        let Some(goodness) = estimate.goodness else {
            return Ok(Vec::new());
        };
        let mut misfits: Vec<Misfit> = Misfit::poor_fit(goodness, SIGNIFICANCE_LEVEL)
            .into_iter()
            .collect();
        if problem.equations() <= problem.fitted.count() {
            return Ok(misfits);
        }
        let state = State::new(
            estimate.most_likely_curvature,
            self.markers.skin().place(estimate.contact),
            estimate.indentation.value,
            [0.0; 2],
        );
        let best = settle(&mut problem, state)?;
        let noise = Noise::stated_or_found(goodness);
        let scale = match noise {
            Noise::Stated => 1.0,
            Noise::Found { .. } => estimate.reduced_chi_squared,
        };
        let squares = problem.squares(&best.residuals)?.into_iter();
        let p_values = squares.map(|square| chi_squared_tail(square / scale, NUMBERS));
        misfits.extend(Misfit::outlier(
            problem.counting.iter().copied().zip(p_values),
        ));
        if let Ok(covariance) = problem.covariance(&best.sums) {
            let products = problem.pattern_sums(&best)?;
            misfits.extend(products.misfits(&best.sums, &covariance, &noise));
        }
        Ok(misfits)
    }
}

impl Problem<'_> {
    fn pattern_sums(&self, best: &FitState) -> Result<PatternSums, PressError> {
        let FitState {
            residuals, slopes, ..
        } = best;
        let patterns = self.patterns(&best.state)?;
        let common = self.shared(&patterns)?;
        let by_slopes = slopes.jacobian.tr_mul(&patterns) - slopes.shared.tr_mul(&common);
        let by_patterns = patterns.tr_mul(&patterns) - common.tr_mul(&common);
        let by_residuals = patterns.tr_mul(residuals) - common.tr_mul(&self.shared(residuals)?);
        Ok(PatternSums {
            by_slopes: SMatrix::from_fn(|row, column| by_slopes[(row, column)]),
            by_patterns: SMatrix::from_fn(|row, column| by_patterns[(row, column)]),
            by_residuals: SMatrix::from_fn(|row, _| by_residuals[row]),
        })
    }

    /// Changes of the markers' images due to each pattern of displacements, one column per pattern. A pattern is added
    /// to the displacements of both discs of each marker. The changes are in standard deviations (whitened).
    fn patterns(&self, state: &State) -> Result<DMatrix<f64>, PressError> {
        let fit = self.fit;
        let slopes = self.by_displacements(&self.displaced(state)?)?;
        let mut all = DMatrix::zeros(self.equations(), PATTERNS);
        for (disc, body) in fit.bodies.iter().enumerate() {
            let contact = state.contact(fit.markers.skin(), body)?;
            let markers = self.counting.iter().zip(&self.whiten);
            for (at, (&marker, whiten)) in markers.enumerate() {
                let sight = fit
                    .markers
                    .sight(&state.place, &fit.markers.places()[marker]);
                let mut rows = all.fixed_rows_mut::<NUMBERS>(NUMBERS * at);
                let slopes = slopes.displacements[marker][disc];
                rows += whiten * (slopes * patterns(&contact, &sight));
            }
        }
        Ok(all)
    }
}
