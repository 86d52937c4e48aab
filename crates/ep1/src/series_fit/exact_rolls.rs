//! Estimates from exact rotations and active pads: the set of curvatures that agree with all rolls.

use palpate_statistics::GoodnessOfFit;

use super::{EXACT_LEVEL, Problem, ROLLS_PER_OUTLIER, TOLERANCE};
use crate::crossings::Crossing;
use crate::pad_edge::{BoundedRoll, PadEdgeSet};
use crate::roll_fit::{FitNoise, Observation, RollData, SeriesFit};
use crate::roll_series::undetermined;
use crate::rolled_path::{LocalShape, drive_of};
use crate::series_estimate::Uncertainty;
use crate::{PadCell, RollSeries, SeriesError, SeriesEstimate};

/// If exact readings contradict each other, at most this number of rolls is left out in turn.
const MAX_TRIES: usize = 16;
/// A set of possible mobilities (contact travels per radian) is too small if the standard deviation of the mobility in
/// the set is below this share of that of the fit. Exact rolls from unknown starts hardly ever have such a small set.
/// A set may be nearly empty because the curvature is not quite constant.
const MIN_SPREAD: f64 = 0.4;
/// If a set is too small, the edges of pads are moved outward at most this number of times.
const MAX_MOVES: usize = 6;

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
        if !self.alternates()
            && let Some(set) = self.set(cell, data, fit, 0.0)
        {
            let change = fit.map(|fit| self.change(data, noise, fit, None));
            return self.of_set(set, change.unwrap_or_default());
        }
        let fit = fit.ok_or_else(|| undetermined(self.rolls))?;
        // The first fit has a coarse tolerance. A very small set and the comparison of the rolls need a more accurate
        // fit.
        let fit = SeriesFit::new(data, noise, fit.shape, TOLERANCE).unwrap_or_else(|| fit.clone());
        // If active pads alternate at edges, the pads are not exact: move all edges outward by the largest distance over
        // which pads alternate.
        let widths = Self::widths(data, &fit.shape).filter(|_| self.alternates());
        let width = widths.fold(0.0, f64::max);
        if let Some(set) = self.set(cell, data, Some(&fit), width) {
            return self.of_set(set, self.change(data, noise, &fit, None));
        }
        // Try to leave out each roll in turn, first the roll whose crossings of pad edges contradict the other rolls
        // most.
        let worst = self.p_values(data, &fit);
        if let Some(p_value) = self.change(data, noise, &fit, worst).0 {
            return Err(SeriesError::ChangingCurvature { p_value });
        }
        let mut order: Vec<usize> = (0..data.len()).collect();
        let p_value = |at: &usize| self.reports[data[*at].roll].p_value.unwrap_or(1.0);
        order.sort_by(|one, other| p_value(one).total_cmp(&p_value(other)));
        let set_without = |left_out: &[usize]| {
            let kept = (0..data.len()).filter(|at| !left_out.contains(at));
            let data: Vec<_> = kept.map(|at| data[at].clone()).collect();
            let fit = SeriesFit::new(&data, noise, fit.shape, TOLERANCE)?;
            // The other rolls may also contradict each other, but too little to make the set of possible mobilities
            // empty. A p-value of at most `EXACT_LEVEL` shows this: the readings are then not exact.
            let goodness = GoodnessOfFit::new(fit.chi_squared, fit.freedom);
            let is_sound = width > 0.0 || goodness.p_value > EXACT_LEVEL;
            let change = self.change(&data, noise, &fit, None);
            let is_sound = is_sound && change.0.is_none();
            Some((
                is_sound.then(|| self.set(cell, &data, Some(&fit), width))??,
                change,
            ))
        };
        let mut tried = order.iter().take(MAX_TRIES);
        let without = tried.find_map(|&at| Some((at, set_without(&[at])?)));
        // If the rolls contradict each other even without as many of them as a fit may leave out, end the search.
        let most = (self.rolls.len() / ROLLS_PER_OUTLIER).min(order.len() - 1);
        let can_help = without.is_some() || set_without(&order[..most]).is_some();
        let roll = data[without.as_ref().map_or(order[0], |found| found.0)].roll;
        if !can_help || !self.leaves_out(Some(roll)) {
            let change = self.change(data, noise, &fit, None).0;
            return Err(
                change.map_or(SeriesError::Contradiction { roll }, |p_value| {
                    SeriesError::ChangingCurvature { p_value }
                }),
            );
        }
        let kept = self.reports.iter_mut();
        let kept = kept.filter(|report| report.left_out.is_none());
        kept.for_each(|report| report.p_value = None);
        match without {
            Some((_, (set, change))) => self.of_set(set, change),
            None => self.estimate(),
        }
    }

    /// Whether several pads are active alternately while the contact moves over an edge.
    pub(super) fn alternates(&self) -> bool {
        let mut pairs = self.runs.iter().flat_map(|runs| runs.windows(2));
        pairs.any(|pair| pair[0].last + 1 < pair[1].first && pair[0].centre != pair[1].centre)
    }

    /// The distances across the crossed edges, in radii of the probe, over which the active pad changed. `shape` is the
    /// shape of the object.
    fn widths(data: &[RollData], shape: &LocalShape) -> impl Iterator<Item = f64> + Clone {
        let mobility = shape.relative().try_inverse().unwrap_or_default();
        let observations = data.iter().flat_map(|roll| &roll.observations);
        observations.map(move |(_, one)| match one {
            Observation::Crossing(one) => Crossing::width(&(mobility * one.normal), &one.change),
            Observation::Contact(..) => 0.0,
        })
    }

    /// The set of mobilities (contact travels per radian) that agree with the rolls of `data`. The edges of all pads
    /// are moved outward by `width` (radii of the probe), or further if the set would be too small. `None` if no
    /// mobility agrees with the rolls.
    fn set(
        &self,
        cell: &PadCell,
        data: &[RollData],
        fit: Option<&SeriesFit<3>>,
        mut width: f64,
    ) -> Option<PadEdgeSet> {
        let mut set = self.set_within(cell, data, fit, width)?;
        let Some(fit) = fit.filter(|_| data.iter().all(|roll| !roll.is_start_known)) else {
            return Some(set);
        };
        let least = MIN_SPREAD.powi(6) * fit.covariance.determinant();
        for _ in 0..MAX_MOVES {
            if set.covariance.determinant() >= least {
                break;
            }
            let widths = Self::widths(data, &fit.shape);
            width = (2.0 * width).max(0.25 * widths.clone().sum::<f64>() / widths.count() as f64);
            set = self.set_within(cell, data, Some(fit), width)?;
        }
        Some(set)
    }

    /// The set of mobilities (contact travels per radian) that agree with the rolls of `data`, if the edges of all pads
    /// are moved outward by `width` (radii of the probe). `None` if no mobility agrees with them.
    fn set_within(
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
            bounded.share = 1.0 / Self::equal_rolls(&self.runs, runs);
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
        let set = Uncertainty::Set(Box::new(set));
        let mut found = self.result(&shape, covariance, (true, 1), &paths, None, set);
        (found.change, found.may_change) = change;
        Ok(found)
    }
}
