//! Tests whether displacements contradict the model that was fitted to them.

use nalgebra::{SMatrix, SVector};
use palpate_statistics::{
    Misfit, SIGNIFICANCE_LEVEL, StatedQuantity, chi_squared_tail, ratio_tail,
};

use super::problem::{Problem, finite};
use super::{ForwardFit, Reading};
use crate::least_squares::{EXACTLY, LeastSquares};
use crate::misfit::{Noise, PatternSums, Patterns, patterns, stated_indentation};
use crate::unknowns::{INDENTATION, Square, State, Sums};
use crate::{PressError, PressEstimate};

/// Smallest ratio for which the stated noise is reported as wrong. The ratio compares the stated noise with the noise
/// of the residuals; the larger of both is divided by the smaller.
const MIN_NOISE_RATIO: f64 = 1.5;

impl ForwardFit {
    /// Tests the stated indentation of a reading by a likelihood-ratio test. It fits the displacements twice: without
    /// and with the stated indentation. The test statistic is the increase of chi-squared. Elliptic contacts are not
    /// tested. Markers that `estimate` rejected as outliers are excluded if they are far from the contact. Outliers
    /// near the contact are included, because they may be correct if the stated indentation is wrong.
    ///
    /// # Errors
    /// Returns an error if the displacements alone do not determine the indentation.
    pub fn check_indentation(
        &self,
        reading: &Reading<'_>,
        estimate: Option<&PressEstimate>,
    ) -> Result<Option<Misfit>, PressError> {
        let Some(stated) = reading.indentation.filter(|_| !self.is_elliptic) else {
            return Ok(None);
        };
        self.validate(reading)?;
        let mut kept: Vec<usize> = (0..reading.normal.len()).collect();
        if let Some(estimate) = estimate {
            let distances = reading.markers.distances(estimate.contact);
            let near = 2.0 * estimate.contact_radius.value;
            let mut is_wrong = vec![false; kept.len()];
            for &marker in &estimate.wrong_markers {
                if let Some(is_wrong) = is_wrong.get_mut(marker) {
                    *is_wrong = true;
                }
            }
            kept.retain(|&marker| !is_wrong[marker] || distances[marker] <= near);
        }
        let normal: Vec<f64> = kept.iter().map(|&marker| reading.normal[marker]).collect();
        let tangential: Option<Vec<[f64; 2]>> = reading
            .tangential
            .map(|all| kept.iter().map(|&marker| all[marker]).collect());
        let displacements = Reading {
            markers: &reading.markers.subset(&kept),
            normal: &normal,
            tangential: tangential.as_deref(),
            indentation: None,
        };
        let alone = self.estimate(&displacements)?;
        if alone.only_marker.is_some() {
            return Err(PressError::Undetermined {
                what: "only one marker moved",
            });
        }
        if alone.contact_radius.std.is_infinite() {
            return Ok(None);
        }
        let (problem, state) = self.problem_of(&displacements, &alone);
        let (mut state, least) = problem.minimum(state, EXACTLY, None)?;
        let indentation = Some(stated);
        let with_stated = Reading {
            indentation,
            ..displacements
        };
        let (with_stated, _) = self.problem_of(&with_stated, &alone);
        if !with_stated.fitted.sought[INDENTATION] {
            state.indentation = stated.value;
        }
        let (_, sums) = with_stated.minimum(state, EXACTLY, None)?;
        let increase = sums.chi_squared - least.chi_squared;
        let p_value = match problem.knows_noise() {
            true => chi_squared_tail(increase, 1),
            false => ratio_tail(increase, 1, least.chi_squared, problem.freedom()),
        };
        stated_indentation(stated, &alone.indentation, p_value)
    }

    /// The least-squares problem from which an estimate was computed (with the same markers and noise), and the fit
    /// parameters of the estimate.
    fn problem_of<'a>(
        &'a self,
        reading: &'a Reading<'a>,
        estimate: &PressEstimate,
    ) -> (Problem<'a>, State) {
        let mut problem = Problem::new(self, reading);
        let skin = reading.markers.skin();
        let place = problem.place_at(skin.place(estimate.contact).direction.as_ref());
        let baseline = estimate.baseline.map_or(0.0, |baseline| baseline.value);
        let gain = estimate.gain.map_or(1.0, |gain| gain.value);
        let state = State::new(
            estimate.most_likely_curvature,
            place,
            estimate.indentation.value,
            [baseline, gain],
        );
        problem.keep_window(&state);
        for &marker in &estimate.wrong_markers {
            if let Some(kept) = problem.kept.get_mut(marker) {
                *kept = false;
            }
        }
        problem.normal_std = estimate.normal_std;
        problem.tangential_std = estimate.tangential_std.unwrap_or(problem.tangential_std);
        (problem, state)
    }

    /// Tests an estimate that this fit computed, and returns all contradictions between the readings and the model. A
    /// stated indentation is tested separately by [`Self::check_indentation`]. For an elliptic contact, the Gaussian
    /// approximation, an undetected contact, or a fit with hardly more equations than parameters, only the size of the
    /// residuals is tested. If the residuals are too large for the stated noise, the tests for outliers and for
    /// patterns in the residuals use the noise of the residuals instead.
    ///
    /// # Errors
    /// Errors of [`ForwardFit::estimate`], and [`PressError::OutOfRange`] if the estimate is not from this fit.
    pub fn misfits(
        &self,
        reading: &Reading<'_>,
        estimate: &PressEstimate,
    ) -> Result<Vec<Misfit>, PressError> {
        self.validate(reading)?;
        let poor_fit = estimate
            .goodness
            .and_then(|goodness| Misfit::poor_fit(goodness, SIGNIFICANCE_LEVEL));
        // A contact without an edge has no residuals that depend on the distance from its edge.
        if self.is_elliptic || estimate.contact_radius.std.is_infinite() {
            return Ok(poor_fit.into_iter().collect());
        }
        let (problem, state) = self.problem_of(reading, estimate);
        let sums = problem.sums(&state)?;
        let noise = problem.stated_noise(&state)?;
        let mut misfits: Vec<Misfit> = poor_fit.into_iter().chain(noise).collect();
        let noise = problem.noise(&sums);
        // The following tests are valid only at the minimum of chi-squared. If no contact was detected, the estimate is
        // not at a minimum.
        if let Some((noise, covariance)) = noise.zip(problem.covariance(&sums).ok())
            && estimate.is_detected
        {
            let (reading, p_value) = problem.slipped(&state, &covariance, &noise)?;
            let mut fit = Some((problem, state, sums));
            if p_value < SIGNIFICANCE_LEVEL {
                misfits.push(Misfit::Outlier { reading, p_value });
                // The outlier is excluded from the further tests. Otherwise it could cause a pattern in the residuals,
                // which would be wrongly attributed to the model of the soft body.
                fit = fit.and_then(|(problem, state, _)| problem.without(reading, &state));
            }
            if let Some((problem, state, sums)) = fit
                && let Ok(covariance) = problem.covariance(&sums)
            {
                misfits.extend(problem.pattern_misfits(&state, &sums, &covariance, &noise)?);
            }
        }
        Ok(misfits)
    }
}

impl Problem<'_> {
    /// Returns a misfit if the residuals show that the stated noise is wrong, and `None` if they do not.
    fn stated_noise(&self, state: &State) -> Result<Option<Misfit>, PressError> {
        let contact = self.contact(state)?;
        let (mut normal, mut tangential) = (0.0, 0.0);
        for marker in self.counting() {
            let [inward, x, y] = self.residuals_at(&contact, state, marker);
            normal += inward * inward;
            tangential += x * x + y * y;
        }
        let freedom = self.freedom() as f64 / self.equations().max(1) as f64;
        let markers = self.counting().count();
        let test = |stated: Option<f64>, squares: f64, readings: usize| {
            let stated = stated.filter(|&std| std > 0.0)?;
            let freedom = (freedom * readings as f64) as usize;
            let ratio = (squares / freedom.max(1) as f64).sqrt();
            let larger = chi_squared_tail(squares, freedom);
            let p_value = if ratio > 1.0 { larger } else { 1.0 - larger };
            let is_wrong = ratio.max(ratio.recip()) > MIN_NOISE_RATIO;
            (is_wrong && freedom > 0 && p_value < SIGNIFICANCE_LEVEL).then_some(Misfit::Stated {
                quantity: StatedQuantity::Noise,
                stated,
                estimated: stated * ratio,
                p_value,
            })
        };
        let tangential = || {
            let is_used = self.uses_tangential();
            let stated = self.fit.tangential_std.filter(|_| is_used);
            test(stated, tangential, 2 * markers)
        };
        Ok(test(self.fit.normal_std, normal, markers).or_else(tangential))
    }

    fn pattern_misfits(
        &self,
        state: &State,
        sums: &Sums,
        covariance: &Square,
        noise: &Noise,
    ) -> Result<impl Iterator<Item = Misfit> + use<>, PressError> {
        let contact = self.contact(state)?;
        let mut products = PatternSums {
            by_slopes: SMatrix::zeros(),
            by_patterns: SMatrix::zeros(),
            by_residuals: SVector::zeros(),
        };
        let stds = [self.normal_std, self.tangential_std, self.tangential_std];
        for (marker, slopes) in self.counting().zip(self.slopes(state)?) {
            let patterns: Patterns = patterns(&contact, &self.sight(state, marker));
            let residuals = self.residuals_at(&contact, state, marker);
            for component in 0..self.components() {
                let pattern = patterns.row(component) / stds[component];
                products.by_slopes += self.of_sought(&slopes[component]) * pattern;
                products.by_patterns += pattern.transpose() * pattern;
                products.by_residuals += pattern.transpose() * residuals[component];
            }
        }
        let sum =
            products.by_slopes.sum() + products.by_patterns.sum() + products.by_residuals.sum();
        finite(sum)?;
        Ok(products.misfits(sums, covariance, noise))
    }
}
