//! Watch over the trials of a cell that ends when a statistic is known well enough.

use serde::{Deserialize, Serialize};

use crate::column::Column;
use crate::moments::Moments;
use crate::scale::{exponent, power_of_two};
use crate::task::{Stop, Watched};
use crate::trial::BLOCK;

/// One number of each trial that succeeded, of which the statistic that is watched is the mean, or the root of the mean.
#[derive(Debug)]
pub(crate) struct Watch {
    rule: Stop,
    /// Observations that have been looked at, of those that the column holds.
    seen: usize,
    block: Vec<f64>,
    watched: Terms,
}

/// Moments of the numbers of all blocks that have ended.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) struct Terms {
    /// Power of two by which errors are divided, so that no square overflows or vanishes; `None` before the first.
    per_unit: Option<f64>,
    moments: Moments,
}

impl Watch {
    pub(crate) fn new(rule: Stop) -> Self {
        Self::after(rule, Terms::default())
    }

    /// Watch over trials that follow others.
    pub(crate) fn after(rule: Stop, watched: Terms) -> Self {
        Self {
            rule,
            seen: 0,
            block: Vec::new(),
            watched,
        }
    }

    /// Notes what has been observed since: by this many trials, or nothing where the columns were cleared.
    pub(crate) fn note(&mut self, columns: &[Column], trials: u64) {
        let Some(column) = columns.get(self.rule.quantity) else {
            return;
        };
        let count = column.len();
        if count <= self.seen {
            self.seen = count;
            return;
        }
        let each = (count - self.seen) / trials.max(1) as usize;
        let pairs: Vec<(f64, f64)> = column.pairs().skip(self.seen).collect();
        for of_trial in pairs.chunks(each.max(1)) {
            let terms = of_trial
                .iter()
                .map(|&(estimate, truth)| match self.rule.statistic {
                    Watched::Mean => estimate,
                    Watched::MeanAbsError => (estimate - truth).abs(),
                    Watched::RmsError => {
                        let error = estimate - truth;
                        let per_unit = *self
                            .watched
                            .per_unit
                            .get_or_insert_with(|| power_of_two(-exponent(error)));
                        (error * per_unit) * (error * per_unit)
                    }
                });
            let mean = terms.sum::<f64>() / of_trial.len() as f64;
            if mean.is_finite() {
                self.block.push(mean);
            }
        }
        self.seen = count;
    }

    /// Ends a block, of which the last trial was the last of so many; tells whether that is enough of them.
    pub(crate) fn end_block(&mut self, trials: u64) -> bool {
        self.watched.moments.merge(&Moments::of(&self.block));
        self.block.clear();
        self.seen = 0;
        // After 1, 2, 4, 8 … blocks.
        let is_looked_at = trials.is_multiple_of(BLOCK) && (trials / BLOCK).is_power_of_two();
        is_looked_at && trials >= self.rule.min_trials && self.is_known()
    }

    /// Moments of the blocks that have ended, for a watch over the trials that follow.
    pub(crate) fn watched(&self) -> Terms {
        self.watched
    }

    /// Whether the relative standard error is as small as it is to be.
    fn is_known(&self) -> bool {
        let Terms { moments, .. } = &self.watched;
        let (Some(mean), Some(std)) = (moments.mean(), moments.std()) else {
            return false;
        };
        let of_mean = std / (moments.count() as f64).sqrt();
        let relative = match self.rule.statistic {
            // A root has half the relative error.
            Watched::RmsError => 0.5 * of_mean / mean,
            Watched::Mean | Watched::MeanAbsError => of_mean / mean.abs(),
        };
        std == 0.0 || relative <= self.rule.relative_standard_error
    }
}
