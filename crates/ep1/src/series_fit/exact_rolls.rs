//! Estimates from exact rotations and active pads: the set of curvatures that agree with all rolls.

use super::Problem;
use crate::crossings::Crossing;
use crate::pad_edge::{BoundedRoll, PadEdgeSet};
use crate::roll_fit::{FitNoise, Observation, RollData, SeriesFit};
use crate::roll_series::undetermined;
use crate::rolled_path::{LocalShape, drive_of};
use crate::series_estimate::Uncertainty;
use crate::{PadCell, RollSeries, SeriesError, SeriesEstimate};

/// Even if the rotations are exact, crossings of pad edges may have noise: the active pad may change a little before or
/// after the contact reaches the edge. Fits with several standard deviations of this noise are compared. This constant is
/// the smallest of them, divided by the root mean square distance that the contact moves between the last sample on one
/// pad and the first sample on the next. Each further standard deviation is twice as large.
const MIN_NOISE: f64 = 0.15;
/// The last compared standard deviation is the first above this multiple of the same distance. With a larger noise, pads
/// beside an edge would be active alternately. If they are, larger standard deviations are compared too.
const MAX_NOISE: f64 = 1.0;
/// Prior weight of each standard deviation of the noise of crossings, relative to the weight of exact crossings.
const NOISE_WEIGHT: f64 = 0.1;
/// Crossings are not exact if the probability of exact crossings is below this value.
const MIN_EXACT: f64 = 0.01;
/// A fit with noise of crossings ends if the coefficients of the shape change by less than this value.
const NOISE_TOLERANCE: f64 = 1e-6;

impl Problem<'_> {
    /// The estimate from exact rotations and active pads. `fit` is the least-squares fit to the crossings of pad edges.
    pub(super) fn of_sets(
        &mut self,
        cell: &PadCell,
        data: &[RollData],
        noise: &FitNoise,
        fit: Option<&SeriesFit<3>>,
    ) -> Result<SeriesEstimate, SeriesError> {
        if data.len() < 2 {
            return Err(SeriesError::TooFewRolls { rolls: data.len() });
        }
        let alternates = self.alternates();
        let exact = match alternates {
            false => self.set(cell, data, fit, 0.0),
            true => None,
        };
        let (exact, fit) = match (exact, fit) {
            // If the set is wide, small noise of the crossings does not matter.
            (Some(set), fit) if fit.is_none() || set.is_wide() => {
                let change = fit.map(|fit| self.change(data, noise, fit, None));
                return self.of_set(set, change.unwrap_or_default());
            }
            (_, None) => return Err(undetermined(self.rolls)),
            (set, Some(fit)) => (set, fit),
        };
        let fits = self.noisy_fits(data, noise, fit);
        let order = |one: &usize, other: &usize| fits[*one].0.total_cmp(&fits[*other].0);
        let best = (0..fits.len()).max_by(order);
        let best = best.ok_or_else(|| undetermined(self.rolls))?;
        let (first, best_fit) = (&fits[0].1, &fits[best].1);
        let likelihood = |at: usize| libm::exp(fits[at].0 - fits[best].0);
        let noisy: f64 = (1..fits.len()).map(likelihood).sum::<f64>() * NOISE_WEIGHT;
        let share = exact
            .as_ref()
            .map_or(0.0, |_| likelihood(0) / (likelihood(0) + noisy));
        if share < MIN_EXACT {
            let worst = self.p_values(data, best_fit);
            if let Some(p_value) = self.change(data, noise, first, worst).0 {
                return Err(SeriesError::ChangingCurvature { p_value });
            }
            if self.leaves_out(worst) {
                return self.estimate();
            }
            // If the largest noise fits best, pads would alternate at edges. They do not, so the noise does not explain the
            // readings.
            if worst.is_some() || (best + 1 == fits.len() && !alternates) {
                return Err(match self.change(data, noise, first, None).0 {
                    Some(p_value) => SeriesError::ChangingCurvature { p_value },
                    None => self.contradiction(data),
                });
            }
        }
        // If active pads alternate at edges, the pads are not exact: move all edges outward by the largest distance over
        // which pads alternate.
        let set = match alternates {
            true => self.set(cell, data, Some(fit), self.widths(data, &fit.shape).0),
            false => exact.filter(|_| share > MIN_EXACT),
        };
        let change = self.change(data, noise, first, None);
        let mut all = Vec::with_capacity(fits.len() + 1);
        if let Some(set) = set {
            let mut estimate = self.of_set(set, change)?;
            if share > 1.0 - MIN_EXACT {
                return Ok(estimate);
            }
            estimate.ignore_bounds();
            all.push((likelihood(0) * f64::from(u8::from(!alternates)), estimate));
        }
        all.push((0.0, self.of_fit(best_fit, 1)));
        for (at, (_, fit)) in fits.iter().enumerate() {
            let weight = match at {
                0 => f64::from(u8::from(alternates)),
                _ => NOISE_WEIGHT,
            };
            all.push((likelihood(at) * weight, self.of_fit(fit, 1)));
        }
        let mean = SeriesEstimate::mean(all.iter().map(|one| (one.0, &one.1)));
        let mut found = mean.ok_or_else(|| undetermined(self.rolls))?;
        (found.change, found.may_change) = change;
        Ok(found)
    }

    /// Pairs of the logarithm of the evidence and the fit, for increasing noise of the crossings. The first fit assumes no
    /// such noise.
    fn noisy_fits(
        &self,
        data: &[RollData],
        noise: &FitNoise,
        rough: &SeriesFit<3>,
    ) -> Vec<(f64, SeriesFit<3>)> {
        let (unit, alternates) = (self.widths(data, &rough.shape).1, self.alternates());
        let mut all: Vec<(f64, SeriesFit<3>)> = Vec::new();
        let mut contact_std = 0.0;
        while contact_std < 1.0 {
            let noise = FitNoise {
                contact_std,
                ..*noise
            };
            let fit = SeriesFit::new(data, &noise, rough.shape, NOISE_TOLERANCE);
            // If the curvature changes, the fit may not converge.
            let rough = || all.is_empty().then(|| rough.clone());
            let Some(fit) = fit.or_else(rough) else {
                break;
            };
            let evidence = fit.log_evidence();
            let is_less = all.last().is_some_and(|last| evidence < last.0);
            all.push((evidence, fit));
            let is_large = contact_std > MAX_NOISE * unit && (is_less || !alternates);
            // If the probe does not turn where the active pad changes, the rotations are not exact, and `unit` is 0.
            if is_large || unit == 0.0 {
                break;
            }
            contact_std = (2.0 * contact_std).max(MIN_NOISE * unit);
        }
        all
    }

    /// Whether several pads are active alternately while the contact moves over an edge.
    pub(super) fn alternates(&self) -> bool {
        let mut pairs = self.runs.iter().flat_map(|runs| runs.windows(2));
        pairs.any(|pair| pair[0].last + 1 < pair[1].first && pair[0].centre != pair[1].centre)
    }

    /// The largest distance across an edge, in radii of the probe, in which the active pad changed, and the root mean
    /// square of these distances. `shape` is the shape of the object.
    fn widths(&self, data: &[RollData], shape: &LocalShape) -> (f64, f64) {
        let mobility = shape.relative().try_inverse().unwrap_or_default();
        let (mut largest, mut squares, mut count) = (0.0_f64, 0.0, 0.0);
        for roll in data {
            for (_, one) in &roll.observations {
                if let Observation::Crossing(one) = one {
                    let across = mobility * one.normal / roll.repeats.sqrt();
                    let width = Crossing::width(&across, &one.change);
                    largest = largest.max(width);
                    (squares, count) = (squares + width * width, count + 1.0);
                }
            }
        }
        (largest, (squares / f64::max(count, 1.0)).sqrt())
    }

    /// The set of mobilities (contact travels per radian) that agree with the rolls of `data`, if the edges of all pads
    /// are moved outward by `width` (radii of the probe). `None` if no mobility agrees with them.
    fn set(
        &self,
        cell: &PadCell,
        data: &[RollData],
        fit: Option<&SeriesFit<3>>,
        width: f64,
    ) -> Option<PadEdgeSet> {
        let shape = fit.map_or(LocalShape::FLAT, |fit| fit.shape);
        let mut rolls = Vec::with_capacity(data.len());
        for (at, roll) in data.iter().enumerate() {
            let series = &self.rolls[roll.roll];
            let runs = &self.runs[roll.roll];
            let mut bounded = BoundedRoll::new(series, runs, self.radius, cell, &shape, width)?;
            if let Some(fit) = fit {
                bounded.start = fit.rolls[at].start;
                bounded.response = fit.rolls[at].response.fixed_view::<2, 3>(0, 0).into();
            }
            // Rolls that change pads at the same samples share the errors of these changes. Without shares, they would
            // make the distribution of probability over the set too narrow.
            bounded.share = 1.0 / roll.repeats;
            rolls.push(bounded);
        }
        PadEdgeSet::new(cell, rolls, shape, fit.map(|fit| fit.covariance))
    }

    /// The estimate that follows from a set of possible mobilities (contact travels per radian).
    fn of_set(
        &self,
        set: PadEdgeSet,
        change: (Option<f64>, bool),
    ) -> Result<SeriesEstimate, SeriesError> {
        let mobility = set.mobility();
        let shape = LocalShape::of_mobility(&mobility).ok_or(SeriesError::NotRolling)?;
        if set.is_wide() && set.is_reversed() {
            return Err(SeriesError::NotRolling);
        }
        if set.is_wide() && set.is_open() {
            return Err(undetermined(self.rolls));
        }
        let ends = self.rolls.iter().filter_map(RollSeries::farthest);
        let paths = ends.map(|last| (mobility * drive_of(&last.rotation)).norm());
        let paths: Vec<f64> = paths.collect();
        let covariance = set.covariance;
        let set = Uncertainty::Set(Box::new(set), false);
        let mut found = self.result(&shape, covariance, (true, 1), &paths, None, set);
        (found.change, found.may_change) = change;
        Ok(found)
    }
}
