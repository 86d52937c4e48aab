//! Trials of one cell that one thread runs: whole blocks, or a slice of one.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::column::Column;
use crate::failures::{Failure, Failures};
use crate::histogram::Histogram;
use crate::partial::Partial;
use crate::record::Record;
use crate::sums::{Scratch, Sums};
use crate::trial::{BLOCK, Trial};
use crate::watch::Watch;

/// Observations of one quantity from which on they are summed up before the end of the block, which bounds the memory
/// of trials with many observations.
const MANY: usize = 4 * BLOCK as usize;

/// Listener to the observations of a block, and the number of the trials that made the last of them.
pub(crate) type Watcher<'a> = dyn FnMut(&[Column], u64) + 'a;

/// Buffers that one thread reuses from block to block.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    record: Record,
    scratch: Scratch,
}

/// Statistics of consecutive blocks.
#[derive(Debug)]
pub(crate) struct Part {
    trials: u64,
    failures: Failures,
    /// Histogram of the errors of each quantity, over all blocks.
    histograms: Vec<Histogram>,
    /// Sums of each quantity in each block.
    blocks: Vec<Vec<Sums>>,
}

/// Observations of some of the trials of a block, which are summed up when the whole block is there.
#[derive(Debug)]
pub(crate) struct Slice {
    trials: u64,
    failures: Failures,
    columns: Vec<Column>,
    /// Number of observations of each quantity after each trial.
    ends: Vec<usize>,
}

/// Block of which slices are put together in their order.
#[derive(Debug, Default)]
pub(crate) struct Assembled {
    columns: Vec<Column>,
    sums: Vec<Sums>,
    scratch: Scratch,
}

impl Part {
    /// Part without blocks.
    pub(crate) fn new(quantities: usize) -> Self {
        Self {
            trials: 0,
            failures: Failures::default(),
            histograms: vec![Histogram::default(); quantities],
            blocks: Vec::new(),
        }
    }

    /// Runs the block that follows; cut short where the run is cancelled, which drops all of it. `watch` is told after
    /// each trial that succeeded what has been recorded since the observations were last summed up.
    #[inline(never)] // by this name instructions are counted
    pub(crate) fn run_block(
        &mut self,
        trial: &(impl Trial + ?Sized),
        trials: Range<u64>,
        workspace: &mut Workspace,
        cancelled: &AtomicBool,
        mut watch: Option<&mut Watcher<'_>>,
    ) {
        let Workspace { record, scratch } = workspace;
        let quantities = self.histograms.len();
        record.set_quantities(quantities);
        let mut sums = vec![Sums::default(); quantities];
        let histograms = &mut self.histograms;
        let failures = &mut self.failures;
        let mut at = trials.start;
        while at < trials.end && !cancelled.load(Ordering::Relaxed) {
            let before = at;
            at += run_some(trial, at..trials.end, record, failures);
            if let Some(watch) = &mut watch {
                watch(record.columns(), at - before);
            }
            if record.columns().iter().any(|column| column.len() > MANY) {
                sum_up(record.columns(), &mut sums, histograms, scratch);
                if let Some(watch) = &mut watch {
                    watch(record.columns(), 0);
                }
            }
        }
        sum_up(record.columns(), &mut sums, histograms, scratch);
        if let Some(watch) = &mut watch {
            watch(record.columns(), 0);
        }
        self.blocks.push(sums);
        self.trials += trials.end - trials.start;
    }

    /// Adds its blocks to those that came before.
    pub(crate) fn add_to(self, partial: &mut Partial) {
        partial.trials += self.trials;
        partial.failures.merge(self.failures);
        for (own, more) in partial.histograms.iter_mut().zip(self.histograms) {
            own.merge(more);
        }
        self.blocks
            .into_iter()
            .for_each(|block| partial.fold(block));
    }
}

impl Slice {
    /// Runs some of the trials of a block; cut short where the run is cancelled, which drops all of it.
    pub(crate) fn run(
        trial: &(impl Trial + ?Sized),
        trials: Range<u64>,
        workspace: &mut Workspace,
        cancelled: &AtomicBool,
    ) -> Self {
        let record = &mut workspace.record;
        let quantities = trial.quantities();
        record.set_quantities(quantities);
        let mut failures = Failures::default();
        let mut ends = Vec::new();
        let mut at = trials.start;
        while at < trials.end && !cancelled.load(Ordering::Relaxed) {
            let before = record.lengths();
            let ran = run_some(trial, at..trials.end, record, &mut failures);
            for number in 1..=ran {
                let columns = record.columns().iter().zip(&before);
                // Those that ran together have observed equally often.
                let end = |(column, before): (&Column, &usize)| {
                    before + (column.len() - before) * number as usize / ran as usize
                };
                ends.extend(columns.map(end));
            }
            at += ran;
        }
        let columns = record.columns().iter_mut().map(std::mem::take).collect();
        Self {
            trials: trials.end - trials.start,
            failures,
            columns,
            ends,
        }
    }
}

impl Assembled {
    /// Adds the slice that follows; `watch` is told of each of its trials.
    pub(crate) fn add(
        &mut self,
        slice: Slice,
        partial: &mut Partial,
        mut watch: Option<&mut Watch>,
    ) {
        let quantities = partial.histograms.len();
        self.columns.resize_with(quantities, Column::default);
        self.sums.resize(quantities, Sums::default());
        partial.trials += slice.trials;
        partial.failures.merge(slice.failures);
        let mut starts = vec![0; quantities];
        for ends in slice.ends.chunks_exact(quantities.max(1)) {
            let pieces = self.columns.iter_mut().zip(&slice.columns);
            for ((own, more), (start, &end)) in pieces.zip(starts.iter_mut().zip(ends)) {
                own.append(more, *start..end);
                *start = end;
            }
            if let Some(watch) = &mut watch {
                watch.note(&self.columns, 1);
            }
            if self.columns.iter().any(|column| column.len() > MANY) {
                let histograms = &mut partial.histograms;
                sum_up(
                    &mut self.columns,
                    &mut self.sums,
                    histograms,
                    &mut self.scratch,
                );
                if let Some(watch) = &mut watch {
                    watch.note(&self.columns, 0);
                }
            }
        }
    }

    /// Ends the block.
    pub(crate) fn end(mut self, partial: &mut Partial) {
        let histograms = &mut partial.histograms;
        sum_up(
            &mut self.columns,
            &mut self.sums,
            histograms,
            &mut self.scratch,
        );
        partial.fold(self.sums);
    }
}

/// Runs the first of some trials, or those of the first that run together; gives their number.
#[inline(always)]
fn run_some(
    trial: &(impl Trial + ?Sized),
    trials: Range<u64>,
    record: &mut Record,
    failures: &mut Failures,
) -> u64 {
    match trial.run_together(trials.clone(), record) {
        0 => {
            let first_trial = trials.start;
            if let Err(kind) = record.take(|record| trial.run(first_trial, record)) {
                failures.add(Failure {
                    kind,
                    count: 1,
                    first_trial,
                });
            }
            1
        }
        ran => ran,
    }
}

/// Adds columns to sums and histograms, and clears them.
fn sum_up(
    columns: &mut [Column],
    sums: &mut [Sums],
    histograms: &mut [Histogram],
    scratch: &mut Scratch,
) {
    for ((column, sums), histogram) in columns.iter_mut().zip(sums).zip(histograms) {
        sums.merge(&Sums::of(column, histogram, scratch));
        column.clear();
    }
}
