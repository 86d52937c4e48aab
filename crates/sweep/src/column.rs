//! The observations of one quantity until they are summed up.

use std::ops::Range;

use crate::observation::Observations;

/// Placeholder for a standard deviation that was not reported; lower than any that can be reported, for those are at
/// least 0.
pub(crate) const UNREPORTED: f64 = -1.0;

/// The truth of some observations; none is −0.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) enum Truths {
    /// There are no observations.
    #[default]
    None,
    /// One truth shared by all observations.
    Same(f64),
    /// Truth of each observation, in their order.
    Varied(Vec<f64>),
}

/// Observations of one quantity, in the order of the trials.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Column {
    estimates: Vec<f64>,
    stds: Vec<f64>,
    truths: Truths,
    /// Verdicts of trials on whether their 95 % interval holds the truth, one per observation; `None` where the
    /// interval is estimate ± 1.96 std. The list ends at the last observation that has a verdict.
    judgements: Vec<Option<bool>>,
    /// Number of observations of trials that have succeeded; the observations after them belong to the running trial.
    kept: usize,
}

impl Column {
    /// Adds observations of the running trial, or of several trials that ran together.
    #[inline(always)]
    pub(crate) fn push<const N: usize>(&mut self, observations: &Observations<N>) {
        if !matches!(self.truths, Truths::Same(truth) if truth == observations.truth) {
            self.note(observations.truth + 0.0, N);
        }
        let stds = observations.stds.unwrap_or([UNREPORTED; N]);
        self.estimates.extend_from_slice(&observations.estimates);
        self.stds.extend_from_slice(&stds);
    }

    /// Sets the verdict on whether the interval of the last observation holds the truth; `None` leaves it to the
    /// standard deviation.
    #[inline]
    pub(crate) fn judge(&mut self, interval_holds: Option<bool>) {
        if interval_holds.is_some() {
            self.judgements.resize(self.estimates.len() - 1, None);
            self.judgements.push(interval_holds);
        }
    }

    /// Records the truth of the next `count` observations where it differs from that of all observations before.
    #[inline(never)]
    fn note(&mut self, truth: f64, count: usize) {
        match &mut self.truths {
            Truths::None => self.truths = Truths::Same(truth),
            Truths::Same(same) => {
                let mut truths = vec![*same; self.estimates.len()];
                truths.resize(truths.len() + count, truth);
                self.truths = Truths::Varied(truths);
            }
            Truths::Varied(truths) => truths.resize(truths.len() + count, truth),
        }
    }

    /// Keeps the observations of the trial that ran.
    #[inline]
    pub(crate) fn keep(&mut self) {
        self.kept = self.estimates.len();
    }

    /// Drops the observations of the trial that ran.
    pub(crate) fn forget(&mut self) {
        self.estimates.truncate(self.kept);
        self.stds.truncate(self.kept);
        self.judgements.truncate(self.kept);
        match &mut self.truths {
            Truths::Varied(truths) => truths.truncate(self.kept),
            truths if self.kept == 0 => *truths = Truths::None,
            Truths::None | Truths::Same(_) => (),
        }
    }

    /// Drops all observations.
    pub(crate) fn clear(&mut self) {
        self.kept = 0;
        self.estimates.clear();
        self.stds.clear();
        self.judgements.clear();
        self.truths = Truths::None;
    }

    /// Adds some of the observations of another column.
    pub(crate) fn append(&mut self, other: &Self, places: Range<usize>) {
        match &other.truths {
            Truths::None => return,
            Truths::Same(truth) => self.note_if_new(*truth, places.len()),
            Truths::Varied(truths) => {
                for (place, &truth) in places.clone().zip(&truths[places.clone()]) {
                    self.append_one(other, place, truth);
                }
                return self.keep();
            }
        }
        self.estimates
            .extend_from_slice(&other.estimates[places.clone()]);
        self.stds.extend_from_slice(&other.stds[places.clone()]);
        for (back, place) in places.clone().rev().enumerate() {
            if other.judgements.get(place).is_some_and(Option::is_some) {
                let end = self.estimates.len() - back;
                self.judgements
                    .resize(self.estimates.len() - places.len(), None);
                self.judgements
                    .extend_from_slice(&other.judgements[places.start..=place]);
                debug_assert_eq!(self.judgements.len(), end);
                break;
            }
        }
        self.keep();
    }

    fn append_one(&mut self, other: &Self, place: usize, truth: f64) {
        self.note_if_new(truth, 1);
        self.estimates.push(other.estimates[place]);
        self.stds.push(other.stds[place]);
        self.judge(other.judgements.get(place).copied().flatten());
    }

    fn note_if_new(&mut self, truth: f64, count: usize) {
        if count > 0 && !matches!(self.truths, Truths::Same(same) if same == truth) {
            self.note(truth, count);
        }
    }

    /// Number of observations.
    pub(crate) fn len(&self) -> usize {
        self.estimates.len()
    }

    /// Estimates, one per observation.
    pub(crate) fn estimates(&self) -> &[f64] {
        &self.estimates
    }

    /// Estimates beside their truths.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (f64, f64)> {
        let estimates = self.estimates.iter().copied().enumerate();
        estimates.filter_map(|(place, estimate)| match &self.truths {
            Truths::None => None,
            Truths::Same(truth) => Some((estimate, *truth)),
            Truths::Varied(truths) => Some((estimate, truths[place])),
        })
    }

    /// Standard deviations of the estimates; [`UNREPORTED`] where a trial gave none.
    pub(crate) fn stds(&self) -> &[f64] {
        &self.stds
    }

    /// Verdicts on whether intervals hold the truth, one per observation from the first on; `None`, or beyond the end
    /// of the slice, where the standard deviation decides.
    pub(crate) fn judgements(&self) -> &[Option<bool>] {
        &self.judgements
    }

    /// Truths of the estimates.
    pub(crate) fn truths(&self) -> &Truths {
        &self.truths
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push(column: &mut Column, truth: f64) {
        column.push(&Observations {
            estimates: [0.0],
            truth,
            stds: None,
        });
    }

    #[test]
    fn a_truth_is_the_same_until_it_is_not() {
        let mut column = Column::default();
        assert_eq!(column.truths(), &Truths::None);
        push(&mut column, -0.0);
        push(&mut column, 0.0);
        assert_eq!(column.truths(), &Truths::Same(0.0));
        push(&mut column, 1.0);
        push(&mut column, 0.0);
        assert_eq!(column.truths(), &Truths::Varied(vec![0.0, 0.0, 1.0, 0.0]));
        column.clear();
        assert_eq!((column.len(), column.truths()), (0, &Truths::None));
    }

    #[test]
    fn judgements_stay_with_their_observations() {
        let mut column = Column::default();
        push(&mut column, 0.0);
        column.judge(None);
        push(&mut column, 0.0);
        column.judge(Some(false));
        column.keep();
        push(&mut column, 0.0);
        column.judge(Some(true));
        column.forget();
        push(&mut column, 0.0);
        column.judge(None);
        assert_eq!(column.judgements(), [None, Some(false)]);
        assert_eq!(column.len(), 3);
        column.clear();
        assert_eq!(column, Column::default());
    }

    #[test]
    fn what_is_forgotten_leaves_no_truth() {
        let mut column = Column::default();
        push(&mut column, 3.0);
        column.forget();
        assert_eq!(column, Column::default());
        push(&mut column, 1.0);
        column.keep();
        push(&mut column, 2.0);
        push(&mut column, 1.0);
        column.forget();
        assert_eq!(column.truths(), &Truths::Varied(vec![1.0]));
        assert_eq!(column.len(), 1);
    }
}
