//! A run of consecutive blocks of one cell, and the joining of neighbouring runs.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::failures::{Failure, Failures};
use crate::histogram::Histogram;
use crate::record::Record;
use crate::summary::{CellStatistics, Summary};
use crate::sums::{Scratch, Sums};
use crate::trial::{BLOCK, Cell, blocks};

/// Observations of one quantity from which on they are summed up before the end of the block, which bounds the memory
/// of trials with many observations.
const MANY: usize = 4 * BLOCK as usize;

/// Buffers that one thread reuses from block to block.
#[derive(Debug, Default)]
pub(crate) struct Workspace {
    record: Record,
    scratch: Scratch,
}

/// Statistics of some consecutive blocks of one cell, before they are complete.
#[derive(Debug)]
struct Part {
    cell: usize,
    first_block: u64,
    blocks: u64,
    failures: Failures,
    /// Histogram of the errors of each quantity, over all blocks; merging is exact in any order.
    histograms: Vec<Histogram>,
    /// Sums of each quantity in each block, block after block. The first block's may stand for several blocks that were
    /// folded into one.
    sums: Vec<Sums>,
}

impl Part {
    fn new(cell: usize, first_block: u64, quantities: usize) -> Part {
        Part {
            cell,
            first_block,
            blocks: 0,
            failures: Failures::default(),
            histograms: vec![Histogram::default(); quantities],
            sums: Vec::new(),
        }
    }

    /// Runs the block that follows; cut short where the run is cancelled, which drops all of it.
    fn run_next_block(&mut self, cell: &Cell, workspace: &mut Workspace, cancelled: &AtomicBool) {
        let Workspace { record, scratch } = workspace;
        let quantities = self.histograms.len();
        record.set_quantities(quantities);
        let mut sums = vec![Sums::default(); quantities];
        let mut sum_up = |record: &mut Record| {
            let columns = record.columns().iter_mut();
            for ((column, sums), histogram) in columns.zip(&mut sums).zip(&mut self.histograms) {
                sums.merge(&Sums::of(column, histogram, scratch));
                column.clear();
            }
        };

        let start = (self.first_block + self.blocks) * BLOCK;
        let end = cell.trials.min(start.saturating_add(BLOCK));
        let mut trial = start;
        while trial < end && !cancelled.load(Ordering::Relaxed) {
            trial += cell.trial.run_together(trial..end, record);
            if trial == end {
                break;
            }
            if let Err(kind) = record.take(|record| cell.trial.run(trial, record)) {
                self.failures.add(Failure {
                    kind,
                    count: 1,
                    first_trial: trial,
                });
            }
            trial += 1;
            if record.columns().iter().any(|column| column.len() > MANY) {
                sum_up(record);
            }
        }
        sum_up(record);
        self.sums.append(&mut sums);
        self.blocks += 1;
    }

    /// Adds the blocks that follow.
    fn append(&mut self, mut next: Part) {
        self.blocks += next.blocks;
        self.failures.merge(next.failures);
        for (own, more) in self.histograms.iter_mut().zip(next.histograms) {
            own.merge(more);
        }
        self.sums.append(&mut next.sums);
    }

    /// Folds what has been summed so far into its first block; the part must begin its cell.
    fn fold(&mut self) {
        let quantities = self.histograms.len();
        let first_block = quantities.min(self.sums.len());
        let (folded, rest) = self.sums.split_at_mut(first_block);
        for (index, sums) in rest.iter().enumerate() {
            folded[index % quantities].merge(sums);
        }
        self.sums.truncate(quantities);
    }

    fn finish(mut self, trials: u64) -> CellStatistics {
        self.fold();
        let quantities = self.sums.iter().zip(&self.histograms);
        CellStatistics {
            trials,
            failures: self.failures.sorted(),
            quantities: quantities
                .map(|(sums, histogram)| Summary::new(sums, histogram))
                .collect(),
        }
    }
}

#[derive(Debug)]
enum Piece {
    Done(CellStatistics),
    Open(Part),
}

/// Statistics of consecutive blocks of the whole study, with every complete cell already summarised.
#[derive(Debug, Default)]
pub(crate) struct Segment {
    pieces: Vec<Piece>,
}

impl Segment {
    /// Runs the block that follows: this one of the cell with this number.
    #[inline(never)] // by this name instructions are counted
    pub(crate) fn run_block(
        &mut self,
        (number, block): (usize, u64),
        cell: &Cell,
        workspace: &mut Workspace,
        cancelled: &AtomicBool,
    ) {
        let mut part = match self
            .pieces
            .pop_if(|piece| matches!(piece, Piece::Open(part) if part.cell == number))
        {
            Some(Piece::Open(part)) => part,
            _ => Part::new(number, block, cell.trial.quantities()),
        };
        part.run_next_block(cell, workspace, cancelled);
        self.push(part, cell.trials);
    }

    /// Adds the blocks that follow; `trials` are those of each cell of the study.
    pub(crate) fn join(mut self, next: Segment, trials: &[u64]) -> Segment {
        let mut next = next.pieces.into_iter();
        match (self.pieces.pop(), next.next()) {
            (Some(Piece::Open(mut left)), Some(Piece::Open(right))) if left.cell == right.cell => {
                left.append(right);
                let trials = trials[left.cell];
                self.push(left, trials);
            }
            (left, right) => self.pieces.extend(left.into_iter().chain(right)),
        }
        self.pieces.extend(next);
        self
    }

    fn push(&mut self, part: Part, trials: u64) {
        self.pieces.push(if part.blocks == blocks(trials) {
            Piece::Done(part.finish(trials))
        } else {
            Piece::Open(part)
        });
    }

    /// Folds the block sums of the last cell; the segment must begin the study.
    pub(crate) fn fold(&mut self) {
        if let Some(Piece::Open(part)) = self.pieces.last_mut() {
            part.fold();
        }
    }

    /// The statistics of the cells that are complete, in order.
    pub(crate) fn into_statistics(self) -> Vec<CellStatistics> {
        let done = |piece| match piece {
            Piece::Done(statistics) => Some(statistics),
            Piece::Open(_) => None,
        };
        self.pieces.into_iter().filter_map(done).collect()
    }
}
