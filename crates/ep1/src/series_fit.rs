//! Estimates curvature from time series of rolls.

mod exact_rolls;
mod trajectory;

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use palpate_statistics::{GoodnessOfFit, chi_squared_tail, ratio_tail};

use crate::crossings::{Crossing, Run, crossings};
use crate::roll_fit::{EstimatedNoise, FitNoise, MIN_SHARE, Observation, RollData, SeriesFit};
use crate::roll_series::{are_reversed, check, groups, undetermined};
use crate::rolled_path::{LocalShape, MAX_COEFFICIENTS, MIN_ANGLE, RollRotations, drive_of};
use crate::series_estimate::Uncertainty;
use crate::symmetric::{inverse_slopes, largest_spread, matrix};
use crate::{
    Exclusion, Places, RollReport, RollSample, RollSeries, SeriesError, SeriesEstimate,
    SeriesMethod, SeriesNoise,
};

/// A roll is left out as an outlier if its p-value is below this value divided by the number of rolls.
const OUTLIER_LEVEL: f64 = 1e-3;
/// Readings are not exact if their p-value is below this value. The errors of exact crossings are uniformly distributed,
/// so their p-value is very rarely so small.
const EXACT_LEVEL: f64 = 0.05;
/// The curvature changes along the rolls if the p-value of its change is below this value.
const CHANGE_LEVEL: f64 = 3e-3;
/// The residuals may exceed the noise even if the curvature changes. The change is then significant only if chi-squared
/// with the change, divided by chi-squared without it, is at most this value. At a larger ratio, the noise may be larger
/// than stated.
const MAX_REST: f64 = 0.1;
/// If the object may be a paraboloid, and the estimate would then be wrong by more standard errors than this value, the
/// readings do not show whether the curvature changes.
const MAX_CHANGE: f64 = 8.0;
/// If no noise is stated, rolls are tested as outliers only if the root-mean-square residual exceeds this share of the
/// longest path.
const MIN_RESIDUAL: f64 = 1e-3;
/// A fit may leave out rolls as outliers, but at most the number of all rolls divided by this value.
const ROLLS_PER_OUTLIER: usize = 4;
/// Largest distance of a roll's start from the middle of its first pad along each axis, divided by the standard
/// deviation of the start. This distance is a little more than half a pad.
const MAX_START: f64 = 2.2;
/// Standard deviation of the wider prior of unknown starts, divided by that of the usual prior, which is the pitch/√12.
/// The wider standard deviation is about one pitch.
const WIDE_PRIOR: f64 = 3.5;
/// The wider prior of unknown starts is used if it increases the variance of the estimate at most by this factor.
const MAX_INCREASE: f64 = 1.5;
/// A fit ends if the coefficients of the shape change by less than this value.
const TOLERANCE: f64 = 1e-8;
/// Tolerance of a fit that only provides a first guess for the set of mobilities (contact travels per radian) that
/// agree with exact readings.
const ROUGH_TOLERANCE: f64 = 0.1;
/// Largest standard deviation of a mobility (contact travel per radian) that counts as determined, divided by the
/// mobility. With a larger value, the interval of the mobility would nearly reach 0, where the curvature is infinite.
const MAX_SPREAD: f64 = 0.25;
/// If the errors of rotations grow with the rotation, the fit uses the rotations about the contact normal only if their
/// root mean square exceeds their standard deviation by this factor.
const MIN_SPIN: f64 = 2.0;

/// The curvature from time series of rolls of a probe of `radius`.
///
/// # Errors
/// [`SeriesError`] if a number is out of range, if the contacts moved against the rolls, if a roll contradicts the other
/// rolls, or if the rolls do not determine the curvature.
pub fn estimate_series(
    method: SeriesMethod,
    radius: f64,
    places: &Places,
    noise: &SeriesNoise,
    rolls: &[RollSeries],
) -> Result<SeriesEstimate, SeriesError> {
    let runs = check(radius, places, noise, rolls)?;
    let mut problem = Problem {
        method,
        radius,
        places,
        noise,
        rolls,
        runs,
        reports: vec![RollReport::default(); rolls.len()],
    };
    problem.estimate()
}

/// Reduces the bias of `first`, a fit to crossings of pad edges. A contact that crosses an edge started nearer to this edge
/// on average, so the prior of the starts biases the estimate. Therefore a wider prior is used if it increases the
/// variance of the mobility (contact travel per radian) only a little. The inverse of an unbiased mobility M is biased.
/// To remove this bias to first order, M is increased by the mean of δ M⁻¹ δ, where δ is the error of M.
fn unbiased(
    mut data: Vec<RollData>,
    noise: &FitNoise,
    first: SeriesFit<3>,
) -> Option<SeriesFit<3>> {
    for roll in data.iter_mut().filter(|roll| roll.start_limit.is_finite()) {
        roll.start_std *= WIDE_PRIOR;
        roll.start_limit = f64::INFINITY;
    }
    let variance = |fit: &SeriesFit<3>| fit.covariance.trace();
    let mut fit = SeriesFit::new(&data, noise, first.shape, TOLERANCE)
        .filter(|fit| variance(fit) < MAX_INCREASE * variance(&first))
        .unwrap_or(first);
    let relative = fit.shape.relative();
    let root = fit.covariance.cholesky()?.l();
    let errors = root.column_iter().map(|error| matrix(&error.into()));
    let squares: Matrix2<f64> = errors.map(|error| error * relative * error).sum();
    fit.shape = LocalShape::of_mobility(&(relative.try_inverse()? + squares))?;
    Some(fit)
}

struct Problem<'r> {
    method: SeriesMethod,
    radius: f64,
    places: &'r Places,
    noise: &'r SeriesNoise,
    rolls: &'r [RollSeries],
    /// For each roll, its runs: successive samples with the same active pad.
    runs: Vec<Vec<Run>>,
    reports: Vec<RollReport>,
}

impl Problem<'_> {
    fn estimate(&mut self) -> Result<SeriesEstimate, SeriesError> {
        let is_exact = self.has_exact_pads();
        let is_set = is_exact && self.method == SeriesMethod::PadEdge;
        // If the probe spins, the bounds of the set are accurate only near the mobility at which they are linearised.
        let spins = self.rolls.iter().any(|roll| roll.bend() > MIN_ANGLE);
        let tolerance = match is_set && !spins {
            true => ROUGH_TOLERANCE,
            false => TOLERANCE,
        };
        let mut noise = self.fit_noise();
        let rolls = self.rolls;
        if are_reversed(rolls) {
            return Err(SeriesError::NotRolling);
        }
        loop {
            let data = self.prepare();
            let is_used = |roll: &&RollData| !roll.observations.is_empty();
            let usable = data.iter().filter(is_used).count();
            let mut first = SeriesFit::<3>::weighted(&data, &noise, LocalShape::FLAT, tolerance);
            // If the curvature changes, a fit of constant curvature may not converge. Its result is then still good enough
            // as the start of fits with more terms.
            let is_rough = first.is_none() && !noise.is_estimated;
            if is_rough {
                first = SeriesFit::new(&data, &noise, LocalShape::FLAT, ROUGH_TOLERANCE);
            }
            if let (true, Places::Pads(cell)) = (is_set, self.places) {
                let is_determined = |fit: &&SeriesFit<3>| {
                    let mobility = fit.shape.relative().try_inverse().unwrap_or_default();
                    largest_spread(&mobility, &fit.covariance) < MAX_SPREAD
                };
                let first = first.as_ref().filter(is_determined);
                return self.of_sets(cell, &data, &noise, first);
            }
            if usable < 2 {
                return Err(SeriesError::TooFewRolls { rolls: usable });
            }
            let first = first.ok_or_else(|| undetermined(rolls))?;
            let scale = first.estimated.map_or(1.0, |noise| noise.variance);
            // Use the same smallest variance in all fits. Only then are the information criteria of fits with different
            // numbers of terms comparable.
            if let Some(estimated) = first.estimated {
                noise.min_variance = MIN_SHARE * MIN_SHARE * estimated.shared;
            }
            let mobility = first.shape.relative().try_inverse().unwrap_or_default();
            if scale.sqrt() * largest_spread(&mobility, &first.covariance) > MAX_SPREAD {
                // Perhaps one roll contradicts the others so much that the fit seems undetermined.
                let worst = self.p_values(&data, &first);
                if self.leaves_out(worst) {
                    continue;
                }
                return Err(undetermined(rolls));
            }
            let (found, worst) = match self.method {
                SeriesMethod::Trajectory => self.trajectory(&data, &noise, &first),
                SeriesMethod::PadEdge => {
                    let mut worst = self.p_values(&data, &first);
                    let change = self.change(&data, &noise, &first, worst);
                    if change.0.is_some() {
                        worst = None;
                    } else if worst.is_none() && is_rough {
                        return Err(self.contradiction(&data));
                    }
                    let found = unbiased(data, &noise, first).ok_or(SeriesError::NotRolling)?;
                    let mut found = self.of_fit(&found, 1);
                    (found.change, found.may_change) = change;
                    (Some(found), worst)
                }
            };
            if !self.leaves_out(worst) {
                return found.ok_or_else(|| undetermined(rolls));
            }
        }
    }

    /// P-value of a change of the curvature along the rolls. `None` if the change is not significant, or if chi-squared
    /// falls more without the roll `worst` than with the change, after the penalty of 2 for each additional coefficient.
    /// The second result is whether the readings do not show if the curvature changes. `fit` is the fit of a constant curvature.
    fn change(
        &self,
        data: &[RollData],
        noise: &FitNoise,
        fit: &SeriesFit<3>,
        worst: Option<usize>,
    ) -> (Option<f64>, bool) {
        let mut rolls = data.iter().zip(&fit.rolls);
        let worst = rolls.find(|(roll, _)| Some(roll.roll) == worst);
        let without = worst.and_then(|(_, state)| fit.fall_without(state));
        let criterion = |(fall, more): (f64, usize)| 2.0 * more as f64 - fall;
        let is_better =
            |one: &(f64, usize)| without.is_none_or(|without| criterion(*one) < criterion(without));
        let p_value = |(fall, more): (f64, usize)| {
            let rest = (fit.chi_squared - fall).max(0.0);
            let freedom = fit.freedom.saturating_sub(more);
            // If the residuals exceed the noise even with the change, compare the change with the remaining residuals.
            match rest > freedom.max(1) as f64 {
                true if rest > MAX_REST * fit.chi_squared => 1.0,
                true => ratio_tail(fall, more, rest, freedom),
                false => chi_squared_tail(fall, more),
            }
        };
        let changed = fit.changed(data, noise);
        let falls = changed.falls.into_iter().filter(is_better);
        // Multiply by the number of tests (Bonferroni).
        let p_value = 3.0 * falls.map(p_value).fold(1.0, f64::min);
        let change = (p_value < CHANGE_LEVEL).then_some(p_value);
        (change, changed.of_paraboloid > MAX_CHANGE)
    }

    /// The error if rolls contradict each other. It names the roll with the smallest p-value.
    fn contradiction(&self, data: &[RollData]) -> SeriesError {
        let p_value = |roll: &usize| self.reports[*roll].p_value.unwrap_or(1.0);
        let order = |one: &usize, other: &usize| p_value(one).total_cmp(&p_value(other));
        let roll = data.iter().map(|roll| roll.roll).min_by(order);
        SeriesError::Contradiction {
            roll: roll.unwrap_or_default(),
        }
    }

    /// Leaves out the roll `roll` as an outlier, and returns `true`. Returns `false` if `roll` is `None`, or if too
    /// many rolls would be left out: then the model or the noise is wrong, not a roll.
    fn leaves_out(&mut self, roll: Option<usize>) -> bool {
        let is_out = |report: &&RollReport| report.left_out == Some(Exclusion::Inconsistent);
        let out = self.reports.iter().filter(is_out).count();
        let Some(roll) = roll.filter(|_| (out + 1) * ROLLS_PER_OUTLIER <= self.rolls.len()) else {
            return false;
        };
        self.reports[roll].left_out = Some(Exclusion::Inconsistent);
        true
    }

    /// Prepares the rolls that a fit uses.
    fn prepare(&mut self) -> Vec<RollData> {
        let scale = 1.0 / self.radius;
        let mut data = Vec::with_capacity(self.rolls.len());
        let (rolls, has_spin) = (self.rolls, self.has_spin());
        let std = self.noise.rotation_std_rad;
        for (roll, (series, report)) in rolls.iter().zip(&mut self.reports).enumerate() {
            if report.left_out == Some(Exclusion::Inconsistent) {
                continue;
            }
            let samples = &series.samples;
            let is_still = |one: &RollSample| drive_of(&one.rotation) == Vector2::zeros();
            report.left_out = match samples.len() {
                0 | 1 => Some(Exclusion::TooFewSamples),
                _ => samples
                    .iter()
                    .all(is_still)
                    .then_some(Exclusion::NoRotation),
            };
            if report.left_out.is_some() {
                continue;
            }
            let guess = series.start.unwrap_or(samples[0].place) * scale;
            let has_spin = has_spin && series.has_spin;
            let bend = series.bend();
            // If the first rotation of a roll is exactly 0, the rotations are relative to the measured orientation of
            // the first sample. All rotations then share the error of this orientation. This error has the same effect
            // as an error of the stated start, so the start is not exact.
            let is_start_exact = samples[0].rotation != Vector3::zeros() || std == 0.0;
            let mut repeats = 1.0;
            let (mut all, start_std) = match self.places {
                Places::Pads(cell) => {
                    let pitch = cell.pitch * scale;
                    let found = crossings(samples, &self.runs[roll], pitch, cell, self.noise);
                    if found.is_empty() {
                        report.left_out = Some(Exclusion::NoCrossing);
                    }
                    let mut all = groups(samples, scale, false, bend);
                    // Rolls that change pads at the same samples share the errors of these changes. Therefore increase
                    // the errors so that the mean of these rolls has the error of one roll.
                    repeats = Self::equal_rolls(&self.runs, &self.runs[roll]);
                    let growth = repeats.sqrt();
                    all.extend(found.into_iter().map(|mut one| {
                        let at = one.sample as f64 + 0.5;
                        one.change *= growth;
                        (at, one.rotation, Some(Observation::Crossing(one)))
                    }));
                    (all, growth * pitch / 12.0_f64.sqrt())
                }
                Places::Contacts { .. } => (groups(samples, scale, true, bend), f64::INFINITY),
            };
            all.sort_by(|one, other| one.0.total_cmp(&other.0));
            let observations = all.iter().enumerate();
            let observations = observations.filter_map(|(index, one)| Some((index, one.2?)));
            data.push(RollData {
                roll,
                repeats,
                is_start_known: series.start.is_some() && is_start_exact,
                start: guess,
                start_std: series.start.map_or(start_std, |_| std),
                start_limit: series
                    .start
                    .map_or(MAX_START * start_std, |_| f64::INFINITY),
                observations: observations.collect(),
                rotations: RollRotations::new(all.into_iter().map(|one| one.1).collect(), has_spin),
            });
        }
        // If pads alternate at some edges, the places of all crossings are uncertain, also of those at which the pads
        // happen not to alternate.
        if self.alternates() {
            let observations = data.iter_mut().flat_map(|roll| &mut roll.observations);
            let crossings = observations.filter_map(|(_, one)| match one {
                Observation::Crossing(crossing) => Some(crossing),
                Observation::Contact(..) => None,
            });
            let mut crossings: Vec<_> = crossings.collect();
            let square = |one: &Crossing| Crossing::width(&one.normal, &one.change).powi(2);
            let squares = crossings.iter().map(|one| square(one));
            let mean = squares.sum::<f64>() / crossings.len().max(1) as f64;
            for one in &mut crossings {
                one.variance += (mean - square(one)).max(0.0) / 12.0;
            }
        }
        data
    }

    /// Number of rolls with the runs `all` that change pads at the same samples as a roll with the runs `runs`.
    fn equal_rolls(all: &[Vec<Run>], runs: &[Run]) -> f64 {
        let is_same = |other: &&Vec<Run>| {
            let mut firsts = other.iter().zip(runs);
            other.len() == runs.len() && firsts.all(|(a, b)| a.first == b.first)
        };
        all.iter().filter(is_same).count() as f64
    }

    fn fit_noise(&self) -> FitNoise {
        FitNoise {
            contact_std: match self.places {
                Places::Contacts { std } if self.is_noise_stated() => std / self.radius,
                Places::Contacts { .. } => 1.0,
                Places::Pads(_) => 0.0,
            },
            rotation_std: self.noise.rotation_std_rad,
            relative_sample_std: self.noise.relative_sample_std,
            relative_roll_std: self.noise.relative_rotation_std,
            is_estimated: !self.is_noise_stated(),
            min_variance: 0.0,
            prior: [0.0; MAX_COEFFICIENTS],
        }
    }

    /// Whether the fit uses the measured rotations about the contact normal. If the errors of rotations grow with the
    /// rotation, and if these rotations are not larger than their errors, the rolls are assumed not to spin: the errors
    /// would turn the paths by wrong angles.
    fn has_spin(&self) -> bool {
        let noise = self.noise;
        let relative = libm::hypot(noise.relative_rotation_std, noise.relative_sample_std);
        let ends = self.rolls.iter().filter_map(RollSeries::farthest);
        let in_stds = ends.map(|last| {
            let std = relative * drive_of(&last.rotation).norm();
            last.rotation.z / libm::hypot(std, noise.rotation_std_rad).max(f64::MIN_POSITIVE)
        });
        let square: f64 = in_stds.map(|spin| spin * spin).sum();
        relative == 0.0 || square > MIN_SPIN * MIN_SPIN * self.rolls.len() as f64
    }

    /// Whether the noise of the readings is stated or follows from the pads. If not, it is estimated from the
    /// residuals.
    fn is_noise_stated(&self) -> bool {
        !self.noise.is_exact() || !matches!(self.places, Places::Contacts { std: 0.0 })
    }

    fn has_exact_pads(&self) -> bool {
        matches!(self.places, Places::Pads(_)) && self.noise.is_exact()
    }

    /// Stores the p-value of each roll. Returns the roll that contradicts the other rolls most; `None` if no
    /// contradiction is significant.
    fn p_values<const N: usize>(&mut self, data: &[RollData], fit: &SeriesFit<N>) -> Option<usize> {
        let lengths = fit.rolls.iter().map(|roll| roll.end.norm());
        let longest = lengths.fold(0.0, f64::max);
        // If the noise is estimated, rolls are not tested as outliers in two cases: if the residuals are so small that they
        // may be errors of the contact model, or if they contradict the noise model, so that their scatter does not
        // measure the noise.
        let is_small = |noise: EstimatedNoise| noise.mean_square.sqrt() < MIN_RESIDUAL * longest;
        let is_untested = |noise: EstimatedNoise| noise.misfit.is_some() || is_small(noise);
        if fit.estimated.is_some_and(is_untested) {
            return None;
        }
        let mut worst = (OUTLIER_LEVEL / data.len() as f64, 0.0, None);
        for (roll, state) in data.iter().zip(&fit.rolls) {
            let Some((fall, freedom)) = fit.fall_without(state) else {
                continue;
            };
            if freedom == 0 || roll.observations.is_empty() {
                continue;
            }
            let others = (fit.chi_squared - fall).max(0.0);
            let of_others = fit.freedom.saturating_sub(freedom);
            let p_value = match fit.estimated {
                // If the model has too few terms for the curvature along the rolls, exact readings contradict every fit, in
                // all rolls. So compare this roll with the scatter of the other rolls (F test).
                None if self.has_exact_pads() && others > of_others as f64 => {
                    ratio_tail(fall, freedom, others, of_others)
                }
                None => chi_squared_tail(fall, freedom),
                // The noise is estimated, so compare this roll with the scatter between the other rolls (F test). This
                // scatter may be much larger than the noise of samples.
                Some(noise) => {
                    let others = (fit.shared_chi_squared() - fall).max(0.0);
                    let of_others = noise.shared_freedom.round() as usize;
                    ratio_tail(fall, freedom, others, of_others.saturating_sub(freedom))
                }
            };
            self.reports[roll.roll].p_value = Some(p_value);
            // Several p-values may be so small that they are rounded to 0. The roll with the largest mean square
            // contradicts the others most.
            let mean_square = fall / freedom as f64;
            if p_value < worst.0 || (p_value == worst.0 && mean_square > worst.1) {
                worst = (p_value, mean_square, Some(roll.roll));
            }
        }
        worst.2
    }

    /// The covariance of a fit is the inverse of its information matrix, multiplied by this factor.
    fn variance<const N: usize>(&self, fit: &SeriesFit<N>) -> f64 {
        // Exact readings of pads determine the rotation at a crossing only up to the rotation between two samples. The
        // assumed errors contain this uncertainty. If the polynomial has too few terms for the curvature along the
        // rolls, the residuals exceed the assumed errors. Then χ² per degree of freedom increases the covariance.
        let goodness = || GoodnessOfFit::new(fit.chi_squared, fit.freedom);
        match fit.estimated {
            Some(noise) => noise.variance,
            None if self.method == SeriesMethod::PadEdge => 1.0,
            None if self.has_exact_pads() && goodness().p_value < EXACT_LEVEL => {
                fit.chi_squared / fit.freedom.max(1) as f64
            }
            None => 1.0,
        }
    }

    fn of_fit<const N: usize>(&self, fit: &SeriesFit<N>, terms: usize) -> SeriesEstimate {
        let covariance = fit.covariance.fixed_view::<3, 3>(0, 0) * self.variance(fit);
        let uncertainty = match fit.estimated {
            Some(noise) => Uncertainty::Student(noise.freedom as usize),
            None if self.noise.is_exact() => Uncertainty::NormalMobility,
            None => Uncertainty::NormalForm,
        };
        let goodness = GoodnessOfFit::new(fit.chi_squared, fit.freedom);
        let goodness = match fit.estimated.and_then(|noise| noise.misfit) {
            Some(p_value) => Some(GoodnessOfFit {
                p_value,
                ..goodness
            }),
            // If pads alternate at edges, the places have noise of unknown size, so the goodness of fit is unknown.
            None if self.has_exact_pads() && self.alternates() => None,
            None => self.is_noise_stated().then_some(goodness),
        };
        let paths: Vec<f64> = fit.rolls.iter().map(|roll| roll.end.norm()).collect();
        let (shape, terms) = (&fit.shape, (terms == 1, terms));
        self.result(shape, covariance, terms, &paths, goodness, uncertainty)
    }

    /// The estimate for a shape. `covariance` is the covariance of the entries uu, uv, vv of the mobility if
    /// `is_of_mobility` is true, otherwise of the curvature form.
    fn result(
        &self,
        shape: &LocalShape,
        covariance: Matrix3<f64>,
        (is_of_mobility, terms): (bool, usize),
        paths: &[f64],
        goodness: Option<GoodnessOfFit>,
        uncertainty: Uncertainty,
    ) -> SeriesEstimate {
        let relative = shape.relative();
        let slopes = match is_of_mobility {
            true => inverse_slopes(&relative),
            false => Matrix3::identity(),
        };
        let covariance = slopes * covariance * slopes.transpose();
        let arc_length = self.radius * paths.iter().sum::<f64>() / paths.len().max(1) as f64;
        SeriesEstimate::new(
            self.radius,
            &relative,
            covariance,
            terms,
            (self.reports.clone(), goodness),
            arc_length,
            uncertainty,
        )
    }
}
