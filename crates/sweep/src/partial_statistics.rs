//! Statistics of some consecutive trials of a cell.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::cell::Trial;
use crate::column::Column;
use crate::histogram::Histogram;
use crate::summary::{CellStatistics, Summary};
use crate::summary::{Failure, Failures};
use crate::sums::Sums;
use crate::trial_record::{Record, TrialObservations};

/// Sums over the observations of one quantity, and the histogram of their errors. All statistics of the quantity are
/// computed from them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Accumulator {
    histogram: Histogram,
    /// Sums over each block of consecutive trials, in the order of the blocks. [`Self::fold`] merges all of them into
    /// the first entry.
    blocks: Vec<Sums>,
}

impl Accumulator {
    /// Adds the observations of the next block, which are in `column`, and empties `column`.
    pub(crate) fn add(&mut self, column: &mut Column) {
        self.blocks.push(column.sum_up(&mut self.histogram));
    }

    /// Merges the sums of all blocks into those of the first block. The first block must contain the first trial of the
    /// cell.
    fn fold(&mut self) {
        if let Some((first, rest)) = self.blocks.split_first_mut() {
            rest.iter().for_each(|block| first.merge(block));
            self.blocks.truncate(1);
        }
    }

    fn merge(&mut self, next: Self) {
        self.histogram.merge(next.histogram);
        self.blocks.extend(next.blocks);
        self.fold();
    }

    pub(crate) fn sums(&self) -> Sums {
        self.blocks.first().copied().unwrap_or_default()
    }

    pub(crate) fn drop_histogram(&mut self) {
        self.histogram = Histogram::default();
    }

    fn summary(&self) -> Summary {
        Summary::new(&self.sums(), &self.histogram)
    }
}

/// Statistics of consecutive blocks of a cell's trials, with one accumulator per quantity.
#[derive(Clone, Debug, Default)]
pub(crate) struct Partial {
    pub(crate) trials: u64,
    pub(crate) failures: Failures,
    pub(crate) quantities: Vec<Accumulator>,
}

/// Function that is called for each trial. It receives the number of the trial, and the observations of the trial or
/// the kind of its failure.
pub(crate) type TrialReader<'a> = dyn FnMut(u64, Result<&TrialObservations<'_>, &'static str>) + 'a;

impl Partial {
    pub(crate) fn new(quantities: usize) -> Self {
        Self {
            quantities: vec![Accumulator::default(); quantities],
            ..Self::default()
        }
    }

    #[inline(never)] // This function is not inlined, because instructions are counted by its name.
    pub(crate) fn run_block(
        &mut self,
        trial: &dyn Trial,
        trials: Range<u64>,
        record: &mut Record,
        cancelled: &AtomicBool,
        reader: Option<&mut TrialReader<'_>>,
    ) {
        self.trials += trials.end - trials.start;
        let failures = run_trials(trial, trials, record, cancelled, reader);
        self.failures.merge(failures);
        self.add_block(record.columns());
    }

    fn add_block(&mut self, columns: &mut [Column]) {
        for (accumulator, column) in self.quantities.iter_mut().zip(columns) {
            accumulator.add(column);
        }
    }

    pub(crate) fn fold(&mut self) {
        self.quantities.iter_mut().for_each(Accumulator::fold);
    }

    pub(crate) fn merge(&mut self, next: Self) {
        self.trials += next.trials;
        self.failures.merge(next.failures);
        self.quantities.resize_with(
            next.quantities.len().max(self.quantities.len()),
            Accumulator::default,
        );
        for (own, more) in self.quantities.iter_mut().zip(next.quantities) {
            own.merge(more);
        }
    }

    pub(crate) fn statistics(&self) -> CellStatistics {
        CellStatistics {
            trials: self.trials,
            failures: self.failures.clone().sorted(),
            quantities: self.quantities.iter().map(Accumulator::summary).collect(),
        }
    }
}

/// Observations of some consecutive trials within a block, the group of trials whose sums are computed together. The
/// sums are computed when all trials of the block are complete. So the result does not depend on how a block is divided
/// into slices.
#[derive(Debug, Default)]
pub(crate) struct Slice {
    trials: u64,
    failures: Failures,
    columns: Vec<Column>,
}

impl Slice {
    pub(crate) fn run(
        trial: &dyn Trial,
        trials: Range<u64>,
        record: &mut Record,
        cancelled: &AtomicBool,
        reader: Option<&mut TrialReader<'_>>,
    ) -> Self {
        Self {
            trials: trials.end - trials.start,
            failures: run_trials(trial, trials, record, cancelled, reader),
            columns: record.columns().iter_mut().map(std::mem::take).collect(),
        }
    }

    pub(crate) fn append(&mut self, next: Self) {
        self.trials += next.trials;
        self.failures.merge(next.failures);
        self.columns
            .resize_with(next.columns.len(), Column::default);
        for (own, more) in self.columns.iter_mut().zip(next.columns) {
            own.append(more);
        }
    }

    /// Adds this slice as a block to `partial`, the statistics of the cell. The slice must contain all trials of the
    /// block.
    pub(crate) fn end(mut self, partial: &mut Partial) {
        partial.trials += self.trials;
        partial.failures.merge(self.failures);
        let quantities = partial.quantities.len().max(self.columns.len());
        partial
            .quantities
            .resize_with(quantities, Accumulator::default);
        partial.add_block(&mut self.columns);
        partial.fold();
    }
}

/// Runs trials, adds their observations to `record`, which must be empty before, and returns the failures of the
/// trials.
fn run_trials(
    trial: &dyn Trial,
    trials: Range<u64>,
    record: &mut Record,
    cancelled: &AtomicBool,
    mut reader: Option<&mut TrialReader<'_>>,
) -> Failures {
    record.set_quantities(trial.quantities());
    let mut failures = Failures::default();
    let mut at = trials.start;
    while at < trials.end && !cancelled.load(Ordering::Relaxed) {
        let before = reader.as_ref().map(|_| record.lengths());
        let together = trial.run_together(at..trials.end, record);
        let result = match together {
            0 => trial.run(at, record),
            _ => Ok(()),
        };
        let (result, ran) = (record.verdict(result), together.max(1));
        if let (Some(read), Some(before)) = (&mut reader, before) {
            match result {
                Ok(()) => record.pass_on(at..at + ran, &before, &mut |trial, observed| {
                    read(trial, Ok(observed))
                }),
                Err(kind) => read(at, Err(kind)),
            }
        }
        match result {
            Ok(()) => record.keep(),
            Err(kind) => {
                record.forget();
                failures.add(Failure {
                    kind,
                    count: 1,
                    first_trial: at,
                });
            }
        }
        at += ran;
    }
    failures
}
