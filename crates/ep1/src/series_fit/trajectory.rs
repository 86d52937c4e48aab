//! Estimates the curvature at the start of rolls along which the curvature changes.
//!
//! The fitted polynomial has [`MAX_TERMS`] terms. Each of its terms except the curvature form has a normal prior with
//! mean 0. The standard deviations of the prior follow from the rate (relative change of the curvature per length) at
//! which the curvature changes along the rolls. The rate is unknown, so the estimate is a weighted mean over a range of
//! rates.

use nalgebra::{Matrix2, SMatrix, SVector};

use super::{Problem, TOLERANCE};
use crate::SeriesEstimate;
use crate::roll_fit::{EstimatedNoise, FitNoise, RollData, SeriesFit, inverse_of};
use crate::rolled_path::{LocalShape, MAX_COEFFICIENTS, MAX_TERMS, coefficients};

/// Ratio of each rate to the rate before it.
const RATIO: f64 = 1.5;
/// Number of rates that are smaller than the curvature. With the smallest of them, the curvature is nearly constant.
const SMALLER_RATES: i32 = 4;
/// Largest rate, divided by the curvature of the object or of the probe, whichever is larger.
const MAX_RATE: f64 = 3.5;
/// Penalty for each parameter that the readings determine, in the criterion that weights the rates. With Akaike's
/// penalty of 2, the intervals would be too narrow if noise hides the change of the curvature.
const PENALTY: f64 = 1.0;
/// The polynomial lacks terms of even higher order. Their estimated effect on the curvature is the effect of the fitted
/// terms, multiplied by this factor and by the larger of two ratios: the relative change of the curvature along the
/// rolls, and the square of the likeliest rate times the length of the longest roll.
const NEXT_TERM: f64 = 0.6;
/// Largest number of fits, each with the likeliest rate of the fit before.
const MAX_FITS: usize = 3;
/// If the curvatures of the fitted and the likeliest rate differ by at most this value (in units of the probe's
/// curvature), the error of the linearised fit is negligible.
const LINEAR: f64 = 3e-3;
/// Smallest typical curvature, in units of the probe's curvature.
const MIN_CURVATURE: f64 = 1e-3;

type Coefficients = SVector<f64, MAX_COEFFICIENTS>;

/// A fit of a polynomial shape with a given number of terms.
struct Candidate {
    criterion: f64,
    shape: LocalShape,
    /// Largest change of the curvature form along the rolls, in units of the probe's curvature.
    change: f64,
    noise: Option<EstimatedNoise>,
    estimate: SeriesEstimate,
    /// The roll that contradicts the other rolls most; `None` if no contradiction is significant.
    worst: Option<usize>,
}

impl Problem<'_> {
    /// The estimate, and the roll that contradicts the other rolls most. `first` is the fit of a constant curvature.
    ///
    /// Polynomials with one to three terms are fitted without priors. Akaike's information criterion selects one of
    /// these fits, which determines the reported number of terms, the noise and the outlier.
    pub(super) fn trajectory(
        &mut self,
        data: &[RollData],
        noise: &FitNoise,
        first: &SeriesFit<3>,
    ) -> (SeriesEstimate, Option<usize>) {
        let mut best = self.candidate(data, first);
        if best.noise.is_some_and(|noise| noise.misfit.is_some()) {
            return (best.estimate, best.worst);
        }
        let mut shape = first.shape;
        // If the object is symmetric about the start of the rolls, odd derivatives of the curvature are zero there. A
        // second term of the polynomial then does not improve the fit, but a third term may.
        self.more_terms::<7>(data, noise, &mut shape, &mut best);
        self.more_terms::<12>(data, noise, &mut shape, &mut best);
        let mean = self.mean_of_rates(data, noise, &best, first);
        self.reports.clone_from(&best.estimate.rolls);
        (mean.unwrap_or(best.estimate), best.worst)
    }

    fn candidate<const N: usize>(&mut self, data: &[RollData], fit: &SeriesFit<N>) -> Candidate {
        let deviance = |noise| fit.deviance(&noise);
        Candidate {
            criterion: 2.0 * N as f64 + fit.estimated.map_or(fit.chi_squared, deviance),
            shape: fit.shape,
            change: largest_change(fit),
            noise: fit.estimated,
            worst: self.p_values(data, fit),
            estimate: self.of_fit(fit, fit.shape.terms),
        }
    }

    /// Fits one more term, and replaces `best` by this fit if its criterion is smaller.
    fn more_terms<const N: usize>(
        &mut self,
        data: &[RollData],
        noise: &FitNoise,
        shape: &mut LocalShape,
        best: &mut Candidate,
    ) {
        shape.terms += 1;
        let fit = SeriesFit::<N>::weighted(data, noise, *shape, TOLERANCE);
        let has_noise =
            |fit: &SeriesFit<N>| fit.estimated.is_none_or(|noise| noise.misfit.is_none());
        if let Some(fit) = fit.filter(has_noise) {
            *shape = fit.shape;
            let candidate = self.candidate(data, &fit);
            if candidate.criterion < best.criterion {
                *best = candidate;
            }
        }
    }

    /// The weighted mean of the estimates with different rates. `None` if a fit does not converge.
    fn mean_of_rates(
        &self,
        data: &[RollData],
        noise: &FitNoise,
        best: &Candidate,
        first: &SeriesFit<3>,
    ) -> Option<SeriesEstimate> {
        let form = first.shape.relative() - Matrix2::identity();
        let curvature = form.symmetric_eigenvalues().amax();
        let curvature = curvature.max(best.change).max(MIN_CURVATURE);
        let of_rate = |rate: &f64| prior(curvature, *rate);
        let rates = (-SMALLER_RATES..).map(|power| curvature * RATIO.powi(power));
        let rates = rates.take_while(|rate| *rate < MAX_RATE * curvature.max(1.0));
        let rates: Vec<f64> = rates.collect();
        let mut noise = *noise;
        if let Some(estimated) = best.noise {
            noise.contact_std = estimated.variance.sqrt();
            noise.relative_roll_std = estimated.shared.sqrt();
            noise.is_estimated = false;
        }
        let mut shape = best.shape;
        shape.terms = MAX_TERMS;
        let mut rate = curvature;
        for pass in 0..MAX_FITS {
            let fitted = of_rate(&rate);
            noise.prior = fitted.into();
            let mut fit = SeriesFit::new(data, &noise, shape, TOLERANCE)?;
            shape = fit.shape;
            let (at, variance) = (Coefficients::from(shape.tensors), self.variance(&fit));
            let at_rate = self.of_fit(&fit, MAX_TERMS).entries();
            let mut all = Vec::with_capacity(rates.len());
            for weights in rates.iter().map(of_rate) {
                // The result with another prior follows from the linearised fit.
                let more = weights - fitted;
                let pull = -more.component_mul(&at);
                let information = fit.information + SMatrix::from_diagonal(&more);
                fit.covariance = inverse_of(&information)?;
                let change = fit.covariance * pull;
                let found = at + change;
                let chi_squared = fit.chi_squared
                    - at.dot(&pull)
                    - pull.dot(&change)
                    - found.dot(&weights.component_mul(&found));
                let by_prior = fit.covariance.diagonal().dot(&weights);
                let criterion =
                    chi_squared / variance + PENALTY * (MAX_COEFFICIENTS as f64 - by_prior);
                fit.shape.tensors = found.into();
                let found = self.of_fit(&fit, MAX_TERMS);
                let mut estimate = best.estimate.clone();
                (estimate.curvature, estimate.covariance) = (found.curvature, found.covariance);
                all.push((criterion, estimate));
            }
            let order = |one: &usize, other: &usize| all[*one].0.total_cmp(&all[*other].0);
            let likeliest = (0..all.len()).min_by(order)?;
            let (least, estimate) = &all[likeliest];
            let apart = (estimate.entries() - at_rate).amax() * self.radius;
            if apart > LINEAR && pass + 1 < MAX_FITS {
                rate = rates[likeliest];
                continue;
            }
            let weight = |criterion: f64| libm::exp(0.5 * (least - criterion));
            let mut mean = SeriesEstimate::mean(all.iter().map(|one| (weight(one.0), &one.1)))?;
            fit.shape = shape;
            let ends = fit.rolls.iter().map(|roll| roll.end.norm());
            let turned = rates[likeliest] * ends.fold(0.0, f64::max);
            let share = largest_change(&fit) / shape.relative().norm();
            let constant = self.of_fit(first, 1).entries();
            let share = NEXT_TERM * share.max(turned * turned);
            mean.widen((mean.entries() - constant) * share);
            return Some(mean);
        }
        None
    }
}

/// Inverse variances of the prior of each coefficient for a typical curvature k and a rate q (in inverse radii of the
/// probe); 0 for the curvature form. The entries of the tensor T_m have the standard deviation (m − 2)² k q^(m−2). For
/// comparison, T₄ along a line through the apex of a paraboloid is −3 k³.
fn prior(curvature: f64, rate: f64) -> Coefficients {
    let mut prior = Coefficients::zeros();
    for term in 1..MAX_TERMS {
        let std = (term * term) as f64 * curvature * rate.powi(term as i32);
        let mut weight = 1.0 / (std * std).max(f64::EPSILON);
        // With binomial coefficients as weights, the prior does not depend on the directions of the axes.
        for j in 0..=term + 2 {
            prior[coefficients(term) + j] = weight;
            weight *= (term + 2 - j) as f64 / (j + 1) as f64;
        }
    }
    prior
}

/// Largest change of the curvature form from the start of the rolls to their ends.
fn largest_change<const N: usize>(fit: &SeriesFit<N>) -> f64 {
    let changes = fit.rolls.iter().map(|roll| fit.shape.change(&roll.end));
    changes.fold(0.0, f64::max)
}
