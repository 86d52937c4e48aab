//! The observations of one quantity until they are summed up.

use crate::record::Observation;

/// An estimate and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) estimate: f64,
    /// −1 where none was reported.
    pub(crate) std: f64,
}

/// In place of a standard deviation.
const UNREPORTED: f64 = -1.0;

/// The truth of some observations; none is −0.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) enum Truths {
    /// There are no observations.
    #[default]
    None,
    /// Always the same.
    Same(f64),
    /// Of each observation.
    Varied(Vec<f64>),
}

/// Observations of one quantity, in the order of the trials.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Column {
    entries: Vec<Entry>,
    truths: Truths,
    /// Entries of the trials that have succeeded; the rest are of the one that runs.
    kept: usize,
}

impl Column {
    /// Adds an observation of the trial that runs.
    #[inline]
    pub(crate) fn push(&mut self, observation: &Observation) {
        if !matches!(self.truths, Truths::Same(truth) if truth == observation.truth) {
            self.note(observation.truth + 0.0);
        }
        self.entries.push(Entry {
            estimate: observation.estimate,
            std: observation.std.unwrap_or(UNREPORTED),
        });
    }

    /// Notes a truth that is not the same as all before it.
    #[inline(never)]
    fn note(&mut self, truth: f64) {
        match &mut self.truths {
            Truths::None => self.truths = Truths::Same(truth),
            Truths::Same(same) => {
                let mut truths = vec![*same; self.entries.len()];
                truths.push(truth);
                self.truths = Truths::Varied(truths);
            }
            Truths::Varied(truths) => truths.push(truth),
        }
    }

    /// Keeps the observations of the trial that ran.
    #[inline]
    pub(crate) fn keep(&mut self) {
        self.kept = self.entries.len();
    }

    /// Drops the observations of the trial that ran.
    pub(crate) fn forget(&mut self) {
        self.entries.truncate(self.kept);
        match &mut self.truths {
            Truths::Varied(truths) => truths.truncate(self.kept),
            truths if self.kept == 0 => *truths = Truths::None,
            Truths::None | Truths::Same(_) => (),
        }
    }

    /// Drops all observations.
    pub(crate) fn clear(&mut self) {
        self.kept = 0;
        self.entries.clear();
        self.truths = Truths::None;
    }

    /// How many observations there are.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// The estimates and standard deviations.
    pub(crate) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The truth of the entries.
    pub(crate) fn truths(&self) -> &Truths {
        &self.truths
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push(column: &mut Column, truth: f64) {
        column.push(&Observation {
            estimate: 0.0,
            truth,
            std: None,
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
