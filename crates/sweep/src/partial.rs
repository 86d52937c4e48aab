//! Statistics of some trials of a cell, before they are complete.

use serde::{Deserialize, Serialize};

use crate::failures::Failures;
use crate::histogram::Histogram;
use crate::summary::{CellStatistics, Summary};
use crate::sums::Sums;
use crate::watch::Terms;

/// Sums and histograms of the trials of a task, which can be written down, read back and put together to the last bit.
///
/// ```
/// use palpate_sweep::{Partial, SUPERBLOCK};
///
/// let cell = Partial::default();
/// assert_eq!(cell.statistics().trials, 0);
/// ```
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Partial {
    pub(crate) trials: u64,
    pub(crate) failures: Failures,
    /// Histogram of the errors of each quantity; merging is exact in any order.
    pub(crate) histograms: Vec<Histogram>,
    /// Sums of each quantity, folded in the order of the trials.
    pub(crate) sums: Vec<Sums>,
    /// Numbers by which a rule judges whether these trials are enough, where it is asked again after more of them.
    pub(crate) watched: Option<Terms>,
}

impl Partial {
    pub(crate) fn new(quantities: usize) -> Self {
        Self {
            histograms: vec![Histogram::default(); quantities],
            ..Self::default()
        }
    }

    /// Adds the sums of a block that follows, whose errors are in the histograms.
    pub(crate) fn fold(&mut self, block: Vec<Sums>) {
        if self.sums.is_empty() {
            self.sums = block;
        } else {
            for (own, more) in self.sums.iter_mut().zip(&block) {
                own.merge(more);
            }
        }
    }

    /// Adds the trials of the superblock that follows.
    pub fn merge(&mut self, next: Self) {
        if self.histograms.is_empty() {
            *self = next;
            return;
        }
        self.trials += next.trials;
        self.failures.merge(next.failures);
        for (own, more) in self.histograms.iter_mut().zip(next.histograms) {
            own.merge(more);
        }
        self.fold(next.sums);
    }

    /// Number of trials run, failed ones included.
    pub fn trials(&self) -> u64 {
        self.trials
    }

    /// Statistics of these trials.
    pub fn statistics(&self) -> CellStatistics {
        let quantities = self.sums.iter().zip(&self.histograms);
        CellStatistics {
            trials: self.trials,
            failures: self.failures.clone().sorted(),
            quantities: quantities
                .map(|(sums, histogram)| Summary::new(sums, histogram))
                .collect(),
        }
    }
}
