//! Stores the observations of one quantity until all trials of a block are complete and their sums are computed.

use std::ops::Range;

use crate::cell::BLOCK;
use crate::histogram::Histogram;
use crate::simd_sums::Observed;
use crate::sums::Sums;
use crate::trial_record::{Observation, Observations};

/// Placeholder for a standard deviation that was not reported. A reported standard deviation is at least 0.
pub(crate) const UNREPORTED: f64 = -1.0;

/// Observations of one quantity, in the order of the trials.
///
/// If a successful trial made more than one observation of the quantity, these observations are replaced by their sums,
/// to save memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Column {
    estimates: Vec<f64>,
    /// True values. A value of −0 is stored as 0.
    truths: Vec<f64>,
    /// Standard deviations that the trials reported; [`UNREPORTED`] for an observation without a standard deviation.
    stds: Vec<f64>,
    /// Observations for which the trial itself reported whether its intervals contain the true value. Each entry
    /// contains the index of the observation, and this report for the 50, 80 and 95 % intervals.
    verdicts: Vec<(usize, [bool; 3])>,
    /// Number of stored observations that belong to successful trials. Later observations belong to the trial that is
    /// running.
    kept: usize,
    /// For each trial that made several observations: the number of observations that are stored before this trial, and
    /// the sums of the trial's observations.
    several: Vec<(usize, Sums)>,
    histogram: Histogram,
    errors: Vec<f64>,
}

impl Column {
    #[inline]
    pub(crate) fn push(&mut self, observation: &Observation) {
        if let Some(holds) = observation.interval_holds {
            self.verdicts.push((self.estimates.len(), holds));
        }
        self.estimates.push(observation.estimate);
        self.truths.push(observation.truth + 0.0);
        self.stds.push(observation.std.unwrap_or(UNREPORTED));
    }

    /// Adds the first `count` of `observations`, which come from trials that were run together, one observation per
    /// trial.
    pub(crate) fn extend(&mut self, observations: &Observations<'_>, count: usize) {
        let end = self.estimates.len() + count;
        self.estimates
            .extend_from_slice(&observations.estimates[..count]);
        self.truths.resize(end, observations.truth + 0.0);
        match observations.stds {
            Some(stds) => self.stds.extend_from_slice(&stds[..count]),
            None => self.stds.resize(end, UNREPORTED),
        }
    }

    #[inline]
    pub(crate) fn keep(&mut self) {
        if self.estimates.len() > self.kept + 1 {
            self.sum_up_trial();
        }
        self.keep_each();
    }

    /// Marks all stored observations as observations of successful trials, with one observation per trial.
    #[inline]
    pub(crate) fn keep_each(&mut self) {
        self.kept = self.estimates.len();
    }

    #[inline(never)]
    fn sum_up_trial(&mut self) {
        let mut sums = Sums::default();
        for start in (self.kept..self.estimates.len()).step_by(BLOCK as usize) {
            let end = self.estimates.len().min(start + BLOCK as usize);
            sums.merge(&self.sums(start..end));
            self.histogram.add(&self.errors);
        }
        self.several.push((self.kept, sums.of_trial()));
        self.forget();
    }

    pub(crate) fn forget(&mut self) {
        self.estimates.truncate(self.kept);
        self.truths.truncate(self.kept);
        self.stds.truncate(self.kept);
        while self
            .verdicts
            .pop_if(|(place, _)| *place >= self.kept)
            .is_some()
        {}
    }

    pub(crate) fn append(&mut self, next: Self) {
        let before = self.estimates.len();
        self.estimates.extend(next.estimates);
        self.truths.extend(next.truths);
        self.stds.extend(next.stds);
        let verdicts = next.verdicts.into_iter();
        self.verdicts
            .extend(verdicts.map(|(place, holds)| (before + place, holds)));
        let several = next.several.into_iter();
        self.several
            .extend(several.map(|(place, sums)| (before + place, sums)));
        self.histogram.merge(next.histogram);
        self.keep_each();
    }

    /// Computes the sums of all stored observations, adds their errors to the histogram, and then removes the
    /// observations.
    pub(crate) fn sum_up(&mut self, histogram: &mut Histogram) -> Sums {
        let mut sums = Sums::default();
        let mut start = 0;
        let all = std::mem::take(&mut self.several);
        let last = (self.estimates.len(), Sums::default());
        for (end, of_trial) in all.into_iter().chain([last]) {
            sums.merge(&self.sums(start..end));
            sums.merge(&of_trial);
            histogram.add(&self.errors);
            start = end;
        }
        histogram.merge(std::mem::take(&mut self.histogram));
        self.kept = 0;
        self.forget();
        sums
    }

    /// Sums of the observations with indices in `places`. Each of these observations must be from a different trial.
    /// Afterwards, `self.errors` contains the errors of these observations.
    fn sums(&mut self, places: Range<usize>) -> Sums {
        let observed = Observed {
            estimates: &self.estimates[places.clone()],
            truths: &self.truths[places.clone()],
            stds: &self.stds[places.clone()],
        };
        let mut sums = Sums::of(observed, &mut self.errors);
        let first = self
            .verdicts
            .partition_point(|(place, _)| *place < places.start);
        for &(place, holds) in &self.verdicts[first..] {
            if places.contains(&place) {
                sums.replace_coverage(self.errors[place - places.start], self.stds[place], holds);
            }
        }
        sums
    }

    pub(crate) fn len(&self) -> usize {
        self.estimates.len()
    }

    pub(crate) fn observations(&self, places: Range<usize>) -> impl Iterator<Item = Observation> {
        places.map(|place| {
            let verdict = self
                .verdicts
                .binary_search_by_key(&place, |(place, _)| *place);
            Observation {
                estimate: self.estimates[place],
                truth: self.truths[place],
                std: Some(self.stds[place]).filter(|&std| std != UNREPORTED),
                interval_holds: verdict.ok().map(|found| self.verdicts[found].1),
            }
        })
    }
}
