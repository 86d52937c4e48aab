//! Trials of a cell until a statistic is known well enough.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::column::Column;
use crate::moments::Moments;
use crate::part::{Part, Workspace};
use crate::partial::Partial;
use crate::scale::{exponent, power_of_two};
use crate::task::{Stop, Watched};
use crate::trial::{BLOCK, Trial};

/// Runs blocks of trials until `rule`, if there is one, ends them, or there are `most` trials.
pub(crate) fn run(
    rule: Option<&Stop>,
    trial: &impl Trial,
    most: u64,
    workspace: &mut Workspace,
    cancelled: &AtomicBool,
) -> Partial {
    let mut partial = Partial::new(trial.quantities());
    let mut watch = rule.map(Watch::new);
    let (mut start, mut look) = (0, BLOCK);
    loop {
        let end = most.min(start + BLOCK);
        let mut part = Part::new(trial.quantities());
        let mut note = |columns: &[Column], trials: u64| {
            if let Some(watch) = &mut watch {
                watch.note(columns, trials);
            }
        };
        part.run_block(trial, start..end, workspace, cancelled, Some(&mut note));
        part.add_to(&mut partial);
        if let Some(watch) = &mut watch {
            watch.end_block();
        }
        start = end;
        if start >= most || cancelled.load(Ordering::Relaxed) {
            return partial;
        }
        if start >= look {
            look = look.saturating_mul(2);
            let is_known = |watch: &Watch<'_>| start >= watch.rule.min_trials && watch.is_known();
            if watch.as_ref().is_some_and(is_known) {
                return partial;
            }
        }
    }
}

/// One number of each trial that succeeded, of which the statistic that is watched is the mean, or the root of the mean.
struct Watch<'a> {
    rule: &'a Stop,
    /// Observations that have been looked at, of those that the column holds.
    seen: usize,
    /// Power of two by which errors are divided, so that no square overflows or vanishes; `None` before the first.
    per_unit: Option<f64>,
    block: Vec<f64>,
    moments: Moments,
}

impl<'a> Watch<'a> {
    fn new(rule: &'a Stop) -> Self {
        Self {
            rule,
            seen: 0,
            per_unit: None,
            block: Vec::new(),
            moments: Moments::default(),
        }
    }

    /// Notes what has been observed since: by this many trials, or nothing where the columns were cleared.
    fn note(&mut self, columns: &[Column], trials: u64) {
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

    fn end_block(&mut self) {
        self.moments.merge(&Moments::of(&self.block));
        self.block.clear();
        self.seen = 0;
    }

    /// Whether the relative standard error is as small as it is to be.
    fn is_known(&self) -> bool {
        let (Some(mean), Some(std)) = (self.moments.mean(), self.moments.std()) else {
            return false;
        };
        let of_mean = std / (self.moments.count() as f64).sqrt();
        let relative = match self.rule.statistic {
            // A root has half the relative error.
            Watched::RmsError => 0.5 * of_mean / mean,
            Watched::Mean | Watched::MeanAbsError => of_mean / mean.abs(),
        };
        std == 0.0 || relative <= self.rule.relative_standard_error
    }
}
