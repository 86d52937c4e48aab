//! The runner.

use std::error::Error as _;
use std::io;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use thiserror::Error;

use crate::part::{Segment, Workspace};
use crate::summary::CellStatistics;
use crate::trial::{BLOCK, Cell};

/// Blocks per thread after which sums are folded. Large against the blocks of one job, so that threads rarely wait.
const WAVE: usize = 1024;
/// Most blocks of one job; a job has its own histograms, whose merging must not be felt.
const MAX_JOB: usize = 32;
/// Jobs per thread, where there are few blocks.
const JOBS_PER_THREAD: usize = 8;

/// Settings that must not change results.
#[derive(Clone, Copy, Debug, Default)]
pub struct RunOptions {
    /// Worker threads; by default one per processor.
    pub threads: Option<NonZeroUsize>,
}

/// Why a study could not be run.
#[derive(Debug, Error)]
pub enum SweepError {
    /// The operating system gave no threads.
    #[error("cannot start {} worker threads: {source}", threads.map_or("the default number of".to_owned(), |n| n.to_string()))]
    Threads {
        /// The number asked for.
        threads: Option<NonZeroUsize>,
        /// Cause, from the thread pool.
        source: rayon::ThreadPoolBuildError,
    },
    /// Somebody cancelled the run; what it had found is dropped.
    #[error("the run was cancelled")]
    Cancelled,
    /// The trials of all cells cannot be counted in 64 bits.
    #[error("{cells} cells have more than {} trials together", u64::MAX)]
    TooManyTrials {
        /// Number of cells.
        cells: usize,
    },
}

/// Runs all trials of all cells and gives the statistics of each cell, in order.
///
/// `progress` is told by any thread, after each block, how many trials it had.
///
/// # Errors
/// [`SweepError`], before any trial is run.
///
/// # Panics
/// Where a trial or `progress` does.
pub fn run(
    cells: &[Cell],
    options: &RunOptions,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Vec<CellStatistics>, SweepError> {
    Runner::new(options)?.run(cells, progress)
}

/// The threads of a run, for one after another.
#[derive(Debug)]
pub struct Runner {
    /// None where there are no threads: the calling one does the work.
    pool: Option<rayon::ThreadPool>,
}

impl Runner {
    /// Starts the threads. On platforms that have none, such as WebAssembly, the calling thread does the work.
    ///
    /// # Errors
    /// [`SweepError::Threads`].
    pub fn new(options: &RunOptions) -> Result<Self, SweepError> {
        let threads = options.threads;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.map_or(0, NonZeroUsize::get))
            .build();
        match pool {
            Ok(pool) => Ok(Self { pool: Some(pool) }),
            Err(source) if has_no_threads(&source) => Ok(Self { pool: None }),
            Err(source) => Err(SweepError::Threads { threads, source }),
        }
    }

    /// Runs all trials of all cells on these threads, as [`run`] does.
    ///
    /// # Errors
    /// [`SweepError::TooManyTrials`], before any trial is run.
    ///
    /// # Panics
    /// Where a trial or `progress` does.
    pub fn run(
        &self,
        cells: &[Cell],
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Vec<CellStatistics>, SweepError> {
        self.run_until(&AtomicBool::new(false), cells, progress)
    }

    /// Runs all trials of all cells as [`Runner::run`] does, until another thread sets `cancelled`: then no trial begins.
    ///
    /// # Errors
    /// [`SweepError::TooManyTrials`], before any trial is run; [`SweepError::Cancelled`].
    ///
    /// # Panics
    /// Where a trial or `progress` does.
    pub fn run_until(
        &self,
        cancelled: &AtomicBool,
        cells: &[Cell],
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Vec<CellStatistics>, SweepError> {
        let study = Study::new(cells, cancelled)?;
        let statistics = match &self.pool {
            Some(pool) => pool.install(|| study.run(progress)),
            None => study.run(progress),
        };
        match cancelled.load(Ordering::Relaxed) {
            true => Err(SweepError::Cancelled),
            false => Ok(statistics),
        }
    }
}

/// Whether the platform never has threads, rather than none to spare.
fn has_no_threads(error: &rayon::ThreadPoolBuildError) -> bool {
    let cause = error
        .source()
        .and_then(|cause| cause.downcast_ref::<io::Error>());
    cause.is_some_and(|cause| cause.kind() == io::ErrorKind::Unsupported)
}

/// The blocks of all cells in one sequence.
struct Study<'a> {
    cells: &'a [Cell<'a>],
    /// First block of each cell.
    starts: Vec<u64>,
    blocks: u64,
    cancelled: &'a AtomicBool,
}

impl<'a> Study<'a> {
    fn new(cells: &'a [Cell<'a>], cancelled: &'a AtomicBool) -> Result<Study<'a>, SweepError> {
        let mut starts = Vec::with_capacity(cells.len());
        let (mut blocks, mut trials) = (0u64, 0u64);
        for cell in cells {
            starts.push(blocks);
            blocks += cell.blocks();
            trials = trials
                .checked_add(cell.trials)
                .ok_or(SweepError::TooManyTrials { cells: cells.len() })?;
        }
        Ok(Study {
            cells,
            starts,
            blocks,
            cancelled,
        })
    }

    /// Runs all blocks in waves; after each only the folded sums of the cell that is not complete remain.
    fn run(&self, progress: &(dyn Fn(u64) + Sync)) -> Vec<CellStatistics> {
        let wave = (WAVE * rayon::current_num_threads()) as u64;
        let mut all = Segment::default();
        for start in (0..self.blocks).step_by(wave as usize) {
            let blocks = (self.blocks - start).min(wave) as usize;
            all = all.join(self.run_wave(start, blocks, progress), self.cells);
            all.fold();
        }
        all.into_statistics()
    }

    fn run_wave(&self, start: u64, blocks: usize, progress: &(dyn Fn(u64) + Sync)) -> Segment {
        let jobs = JOBS_PER_THREAD * rayon::current_num_threads();
        let run = |(mut segment, mut workspace): (Segment, Workspace), index: usize| {
            if self.cancelled.load(Ordering::Relaxed) {
                return (segment, workspace);
            }
            let index = start + index as u64;
            let cell = self.starts.partition_point(|&first| first <= index) - 1;
            let block = index - self.starts[cell];
            segment.run_block(self.cells, cell, block, &mut workspace, self.cancelled);
            progress((self.cells[cell].trials - block * BLOCK).min(BLOCK));
            (segment, workspace)
        };
        (0..blocks)
            .into_par_iter()
            .with_max_len((blocks / jobs).clamp(1, MAX_JOB))
            .fold(Default::default, run)
            .map(|(segment, _)| segment)
            .reduce(Segment::default, |left, right| left.join(right, self.cells))
    }
}
