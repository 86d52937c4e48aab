//! The observations of one quantity until they are summed up.

use std::ops::Range;

use crate::observation::{Observation, Observations};

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
    /// Standard deviations that were reported, one per observation; [`UNREPORTED`] where a trial gave none. The list may
    /// end early.
    stds: Vec<f64>,
    truths: Truths,
    /// Verdicts of trials on whether their intervals of 50, 80 and 95 % hold the truth, one per observation; `None` where
    /// the intervals are of the standard deviation. The list may end early.
    judgements: Vec<Option<[bool; 3]>>,
    /// Places of the observations of each trial that made several.
    several: Vec<Range<usize>>,
    /// Number of observations of trials that have succeeded; the observations after them belong to the running trial.
    kept: usize,
}

/// Adds items to a list that may have ended before place `start`, where they belong.
#[inline]
fn extend<T: Copy>(list: &mut Vec<T>, start: usize, items: &[T], missing: T) {
    if !items.is_empty() {
        if list.len() != start {
            list.resize(start, missing);
        }
        list.extend_from_slice(items);
    }
}

impl Column {
    /// Adds an observation of the running trial.
    #[inline]
    pub(crate) fn push(&mut self, observation: &Observation) {
        self.note_if_new(observation.truth + 0.0, 1);
        let start = self.estimates.len();
        self.estimates.push(observation.estimate);
        extend(
            &mut self.stds,
            start,
            observation.std.as_slice(),
            UNREPORTED,
        );
        if observation.interval_holds.is_some() {
            let verdict = [observation.interval_holds];
            extend(&mut self.judgements, start, &verdict, None);
        }
    }

    /// Adds the first `count` observations of trials that ran together.
    pub(crate) fn extend(&mut self, observations: &Observations<'_>, count: usize) {
        self.note_if_new(observations.truth + 0.0, count);
        let start = self.estimates.len();
        self.estimates
            .extend_from_slice(&observations.estimates[..count]);
        let stds = observations.stds.map_or(&[][..], |stds| &stds[..count]);
        extend(&mut self.stds, start, stds, UNREPORTED);
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
        let places = self.kept..self.estimates.len();
        if places.len() > 1 {
            self.several.push(places);
        }
        self.keep_each();
    }

    /// Keeps the observations of trials that made one each.
    #[inline]
    pub(crate) fn keep_each(&mut self) {
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
        self.several.clear();
        self.truths = Truths::None;
    }

    /// Adds the observations that a trial made in another column.
    pub(crate) fn append(&mut self, other: &Self, places: Range<usize>) {
        match &other.truths {
            Truths::None => return,
            Truths::Same(truth) => self.note_if_new(*truth, places.len()),
            Truths::Varied(truths) => {
                for (place, &truth) in places.clone().zip(&truths[places.clone()]) {
                    self.note_if_new(truth, 1);
                    self.append_untold(other, place..place + 1);
                }
                return self.keep();
            }
        }
        self.append_untold(other, places);
        self.keep();
    }

    /// Adds some of the observations of another column, but not their truths.
    fn append_untold(&mut self, other: &Self, places: Range<usize>) {
        fn some<T>(list: &[T], places: Range<usize>) -> &[T] {
            &list[places.start.min(list.len())..places.end.min(list.len())]
        }
        let start = self.estimates.len();
        self.estimates
            .extend_from_slice(&other.estimates[places.clone()]);
        let stds = some(&other.stds, places.clone());
        extend(&mut self.stds, start, stds, UNREPORTED);
        let judgements = some(&other.judgements, places);
        extend(&mut self.judgements, start, judgements, None);
    }

    #[inline]
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

    /// Standard deviations of the estimates, one per observation from the first on; [`UNREPORTED`], or beyond the end of
    /// the slice, where a trial gave none.
    pub(crate) fn stds(&self) -> &[f64] {
        &self.stds
    }

    /// Verdicts on whether intervals hold the truth, one per observation from the first on; `None`, or beyond the end
    /// of the slice, where the standard deviation decides.
    pub(crate) fn judgements(&self) -> &[Option<[bool; 3]>] {
        &self.judgements
    }

    /// Places of the observations of each trial that made several, in their order; every other trial made one at most.
    pub(crate) fn several(&self) -> &[Range<usize>] {
        &self.several
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
        judge(column, truth, None);
    }

    fn judge(column: &mut Column, truth: f64, interval_holds: Option<[bool; 3]>) {
        column.push(&Observation {
            estimate: 0.0,
            truth,
            std: None,
            interval_holds,
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
        judge(&mut column, 0.0, Some([false; 3]));
        column.keep();
        judge(&mut column, 0.0, Some([true; 3]));
        column.forget();
        push(&mut column, 0.0);
        assert_eq!(column.judgements(), [None, Some([false; 3])]);
        assert_eq!(column.len(), 3);
        column.clear();
        assert_eq!(column, Column::default());
    }

    #[test]
    fn what_is_appended_stays_beside_its_observation() {
        let observed = [
            (0.0, None, None),
            (0.0, Some(0.5), None),
            (0.0, None, Some([true; 3])),
            (0.0, None, None),
            (1.0, Some(0.25), Some([false, false, true])),
        ];
        type Observed = (f64, Option<f64>, Option<[bool; 3]>);
        let column = |observed: &[Observed]| {
            let mut column = Column::default();
            for (place, &(truth, std, interval_holds)) in observed.iter().enumerate() {
                column.push(&Observation {
                    estimate: place as f64,
                    truth,
                    std,
                    interval_holds,
                });
            }
            column
        };
        let whole = column(&observed);
        assert_eq!(whole.stds(), [-1.0, 0.5, -1.0, -1.0, 0.25]);
        for cut in 0..=observed.len() {
            // Truths of the first four are the same, those of all are not.
            for source in [&whole, &column(&observed[..4])] {
                let mut appended = Column::default();
                let cut = cut.min(source.len());
                appended.append(source, 0..cut);
                appended.append(source, cut..source.len());
                assert_eq!(appended.estimates(), source.estimates());
                assert_eq!(
                    appended.pairs().collect::<Vec<_>>(),
                    source.pairs().collect::<Vec<_>>()
                );
                let place = |column: &Column, place: usize| {
                    let std = column.stds().get(place).copied();
                    let verdict = column.judgements().get(place).copied();
                    (std.filter(|&std| std != UNREPORTED), verdict.flatten())
                };
                let observed = observed.iter().take(source.len());
                for (at, &(_, std, verdict)) in observed.enumerate() {
                    assert_eq!(place(&appended, at), (std, verdict));
                    assert_eq!(place(source, at), (std, verdict));
                }
            }
        }
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
