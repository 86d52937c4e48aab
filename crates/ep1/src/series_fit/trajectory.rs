//! Estimates the curvature at the start of rolls along which the curvature changes.
//!
//! The fitted polynomial has [`MAX_TERMS`] terms. Each of its terms except the curvature form has a normal prior with
//! mean 0. The standard deviations of the prior follow from the rate (relative change of the curvature per length) at
//! which the curvature changes along the rolls. The rate is unknown, so the estimate is a weighted mean over a range of
//! rates.

use nalgebra::{Matrix2, SMatrix, SVector, Vector3};

use super::{Problem, TOLERANCE};
use crate::SeriesEstimate;
use crate::roll_fit::{EstimatedNoise, FitNoise, RollData, SeriesFit, inverse_of};
use crate::rolled_path::{LocalShape, MAX_COEFFICIENTS, MAX_TERMS, coefficients};

/// Ratio of each rate to the rate before it.
const RATIO: f64 = 2.0;
/// Number of rates that are smaller than the curvature. With the smallest of them, the curvature is nearly constant.
const SMALLER_RATES: i32 = 2;
/// Largest rate, divided by the curvature of the object or of the probe, whichever is larger.
const MAX_RATE: f64 = 2.5;
/// Penalty for each parameter that the readings determine, in the criterion that weights the rates. With Akaike's
/// penalty of 2, the intervals would be too narrow if noise hides the change of the curvature.
const PENALTY: f64 = 1.25;
/// The polynomial lacks terms of even higher order. Their estimated effect on the curvature is the effect of the last two
/// fitted terms, multiplied by this factor.
const NEXT_TERM: f64 = 0.4;
/// Largest number of fits, each with the likeliest rate of the fit before.
const MAX_FITS: usize = 3;
/// If the curvatures of the fitted and the likeliest rate differ by at most this value (in units of the probe's
/// curvature), the error of the linearised fit is negligible.
const LINEAR: f64 = 3e-3;
/// Smallest typical curvature, in units of the probe's curvature.
const MIN_CURVATURE: f64 = 1e-3;

type Coefficients = SVector<f64, MAX_COEFFICIENTS>;
type Square = SMatrix<f64, MAX_COEFFICIENTS, MAX_COEFFICIENTS>;

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
    /// The estimate, and the roll that contradicts the other rolls most. The estimate is a weighted mean over the rates. It
    /// is `None` if its fits do not converge. `first` is the fit of a constant curvature.
    ///
    /// First, polynomials with one to three terms are fitted without priors. Akaike's information criterion selects one of
    /// these fits, which determines the reported number of terms and the noise. If its residuals contradict the noise
    /// model, the estimate is that of a constant curvature.
    pub(super) fn trajectory(
        &mut self,
        data: &[RollData],
        noise: &FitNoise,
        first: &SeriesFit<3>,
    ) -> (Option<SeriesEstimate>, Option<usize>) {
        let mut best = self.candidate(data, first);
        if best.noise.is_some_and(|noise| noise.misfit.is_some()) {
            return (Some(best.estimate), best.worst);
        }
        let mut shape = first.shape;
        // If the object is symmetric about the start of the rolls, odd derivatives of the curvature are zero there. A
        // second term of the polynomial then does not improve the fit, but a third term may.
        self.more_terms::<7>(data, noise, &mut shape, &mut best);
        self.more_terms::<12>(data, noise, &mut shape, &mut best);
        self.reports.clone_from(&best.estimate.rolls);
        let mean = self.mean_of_rates(data, noise, &best, first);
        mean.map_or((None, best.worst), |(mean, worst)| (Some(mean), worst))
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

    /// The weighted mean of the estimates with different rates, and the roll that contradicts the other rolls most.
    /// `None` if the fit does not converge.
    fn mean_of_rates(
        &mut self,
        data: &[RollData],
        noise: &FitNoise,
        best: &Candidate,
        first: &SeriesFit<3>,
    ) -> Option<(SeriesEstimate, Option<usize>)> {
        let form = first.shape.relative() - Matrix2::identity();
        let curvature = form.symmetric_eigenvalues().amax();
        let curvature = curvature.max(best.change).max(MIN_CURVATURE);
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
        let (mut rate, mut mean) = (curvature, None);
        for _ in 0..MAX_FITS {
            noise.prior = prior(curvature, rate).into();
            // With a large rate, the fit may fail to converge. The result with the rate before is then good enough, or a
            // result with the smallest rate.
            let Some(mut fit) = SeriesFit::new(data, &noise, shape, TOLERANCE) else {
                if mean.is_some() || rate == rates[0] {
                    break;
                }
                rate = rates[0];
                continue;
            };
            shape = fit.shape;
            let at_rate = self.of_fit(&fit, MAX_TERMS).entries();
            let rated = Rated::new(&fit, &noise);
            // The polynomial of a candidate may have too few terms for sound readings, so test its outlier again.
            let worst = best.worst.and_then(|_| self.p_values(data, &fit));
            let with_rate = |rate: &f64| rated.with(&prior(curvature, *rate));
            let Some(all) = rates.iter().map(with_rate).collect::<Option<Vec<_>>>() else {
                break;
            };
            // If a rate is too small for the object, the residuals exceed the noise. So the rate with the smallest
            // residuals determines the noise.
            let readings = fit.freedom + 3;
            let order =
                |one: &&WithRate, other: &&WithRate| one.residuals.total_cmp(&other.residuals);
            let least = all.iter().min_by(order)?;
            fit.chi_squared = least.residuals;
            fit.freedom = readings.saturating_sub(least.determined.round() as usize);
            let variance = self.variance(&fit);
            let weighted = all.into_iter().map(|one| {
                (fit.shape.tensors, fit.covariance) = (one.tensors.into(), one.covariance);
                let criterion = one.chi_squared / variance + PENALTY * one.determined;
                fit.chi_squared = one.residuals;
                fit.freedom = readings.saturating_sub(one.determined.round() as usize);
                (criterion, self.of_fit(&fit, MAX_TERMS))
            });
            let all: Vec<_> = weighted.collect();
            let order = |one: &usize, other: &usize| all[*one].0.total_cmp(&all[*other].0);
            let likeliest = (0..all.len()).min_by(order)?;
            let (least, estimate) = &all[likeliest];
            let weight = |criterion: f64| libm::exp(0.5 * (least - criterion));
            let found = SeriesEstimate::mean(all.iter().map(|one| (weight(one.0), &one.1)))?;
            rate = rates[likeliest];
            let fewer = rated.without_last_terms(&prior(curvature, rate))? / self.radius;
            let apart = (estimate.entries() - at_rate).amax() * self.radius;
            let mut result = best.estimate.clone();
            (result.curvature, result.covariance) = (found.curvature, found.covariance);
            result.widen((estimate.entries() - fewer) * NEXT_TERM);
            result.goodness = result.goodness.and(estimate.goodness);
            result.rolls.clone_from(&self.reports);
            mean = Some((result, worst));
            if apart <= LINEAR {
                break;
            }
        }
        mean
    }
}

/// The result of a fit with the prior of one rate.
struct WithRate {
    tensors: Coefficients,
    covariance: Square,
    /// Chi-squared of the readings.
    residuals: f64,
    /// Chi-squared of the readings and of the prior.
    chi_squared: f64,
    /// Number of coefficients that the readings determine.
    determined: f64,
}

/// A linearised fit with a prior, from which the results with other priors follow.
struct Rated {
    at: Coefficients,
    /// Information matrix of the readings, without the prior.
    information: Square,
    /// Minus half of the gradient of the readings' chi-squared.
    gradient: Coefficients,
    /// Chi-squared of the readings. It does not contain the prior.
    chi_squared: f64,
}

impl Rated {
    fn new(fit: &SeriesFit<MAX_COEFFICIENTS>, noise: &FitNoise) -> Self {
        let at = Coefficients::from(fit.shape.tensors);
        let gradient = Coefficients::from(noise.prior).component_mul(&at);
        Self {
            at,
            information: fit.rolls.iter().map(|roll| roll.information).sum(),
            gradient,
            chi_squared: fit.chi_squared - at.dot(&gradient),
        }
    }

    /// The result with a prior of the inverse variances `weights`.
    fn with(&self, weights: &Coefficients) -> Option<WithRate> {
        let pull = self.gradient - weights.component_mul(&self.at);
        let covariance = inverse_of(&(self.information + Square::from_diagonal(weights)))?;
        let change = covariance * pull;
        let found = self.at + change;
        let residuals =
            self.chi_squared + change.dot(&(self.information * change - self.gradient * 2.0));
        Some(WithRate {
            tensors: found,
            covariance,
            residuals,
            chi_squared: residuals + found.dot(&weights.component_mul(&found)),
            determined: MAX_COEFFICIENTS as f64 - covariance.diagonal().dot(weights),
        })
    }

    /// The entries uu, vv and uv of the curvature form, in units of the probe's curvature, if the last two terms of the
    /// polynomial are 0.
    fn without_last_terms(&self, weights: &Coefficients) -> Option<Vector3<f64>> {
        const FEWER: usize = coefficients(MAX_TERMS - 2);
        const LAST: usize = MAX_COEFFICIENTS - FEWER;
        let pull = self.gradient - weights.component_mul(&self.at);
        let information = self.information + Square::from_diagonal(weights);
        let pull = pull.fixed_rows::<FEWER>(0)
            + information.fixed_view::<FEWER, LAST>(0, FEWER) * self.at.fixed_rows::<LAST>(FEWER);
        let change = inverse_of(&information.fixed_view::<FEWER, FEWER>(0, 0).into_owned())? * pull;
        let [uu, uv, vv] = [0, 1, 2].map(|entry| self.at[entry] + change[entry]);
        Some(Vector3::new(uu, vv, uv))
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
