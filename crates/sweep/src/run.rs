//! The runner.

use std::convert::Infallible;
use std::error::Error as _;
use std::io;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use thiserror::Error;

use crate::alive::Alive;
use crate::jobs::{blocks_of_job, blocks_of_wave};
use crate::part::{Segment, Workspace};
use crate::summary::CellStatistics;
use crate::trial::{BLOCK, Cell, Trial, blocks};

/// Settings that must not change results.
#[derive(Clone, Copy, Debug, Default)]
pub struct RunOptions {
    /// Worker threads; by default one per processor.
    pub threads: Option<NonZeroUsize>,
}

/// Lack of threads: the operating system gave none.
#[derive(Debug, Error)]
#[error("cannot start {} worker threads: {source}", threads.map_or("the default number of".to_owned(), |n| n.to_string()))]
pub struct NoThreads {
    threads: Option<NonZeroUsize>,
    source: rayon::ThreadPoolBuildError,
}

/// Reason why a study could not be run; `E` is the error of setting up a cell.
#[derive(Debug, Error)]
pub enum SweepError<E = Infallible> {
    /// Lack of threads.
    #[error(transparent)]
    NoThreads(#[from] NoThreads),
    /// Error of the first cell that could not be set up; what the run had found is dropped.
    #[error("{0}")]
    SetUp(E),
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

impl<E> SweepError<E> {
    /// Error of a run whose cells fail in another way: `map` turns the error of setting up a cell.
    pub fn map_set_up<F>(self, map: impl FnOnce(E) -> F) -> SweepError<F> {
        match self {
            Self::NoThreads(error) => SweepError::NoThreads(error),
            Self::SetUp(error) => SweepError::SetUp(map(error)),
            Self::Cancelled => SweepError::Cancelled,
            Self::TooManyTrials { cells } => SweepError::TooManyTrials { cells },
        }
    }
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
    /// [`NoThreads`].
    pub fn new(options: &RunOptions) -> Result<Self, NoThreads> {
        let threads = options.threads;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.map_or(0, NonZeroUsize::get))
            .build();
        match pool {
            Ok(pool) => Ok(Self { pool: Some(pool) }),
            Err(source) if has_no_threads(&source) => Ok(Self { pool: None }),
            Err(source) => Err(NoThreads { threads, source }),
        }
    }

    /// Number of threads that work.
    pub fn threads(&self) -> NonZeroUsize {
        let threads = self
            .pool
            .as_ref()
            .map(rayon::ThreadPool::current_num_threads);
        threads
            .and_then(NonZeroUsize::new)
            .unwrap_or(NonZeroUsize::MIN)
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
        let trials: Vec<u64> = cells.iter().map(|cell| cell.trials).collect();
        let set_up = |cell: usize| Ok(cells[cell].trial);
        self.run_until(&AtomicBool::new(false), &trials, set_up, progress)
    }

    /// Runs so many `trials` of each cell until another thread sets `cancelled`: then no trial begins.
    ///
    /// The experiment of a cell is set up by any thread when its first trial is due, and dropped after its last: only the
    /// experiments that threads work on are kept. `set_up` must not wait for these threads.
    ///
    /// ```
    /// use std::sync::atomic::AtomicBool;
    /// use palpate_sweep::{Observation, Record, RunOptions, Runner, Trial};
    ///
    /// /// Estimates its truth without an error.
    /// struct Exact(f64);
    /// impl Trial for Exact {
    ///     fn quantities(&self) -> usize { 1 }
    ///     fn run(&self, _trial: u64, record: &mut Record) -> Result<(), &'static str> {
    ///         let (estimate, truth) = (self.0, self.0);
    ///         record.observe(0, Observation { estimate, truth, std: None, interval_holds: None });
    ///         Ok(())
    ///     }
    /// }
    ///
    /// let runner = Runner::new(&RunOptions::default())?;
    /// let set_up = |cell| u8::try_from(cell).map(|cell| Exact(cell.into()));
    /// let cells = runner.run_until(&AtomicBool::new(false), &[20; 3], set_up, &|_finished| ())?;
    /// assert_eq!(cells[2].quantities[0].mean, Some(2.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SweepError::TooManyTrials`], before any trial is run; [`SweepError::Cancelled`]; [`SweepError::SetUp`].
    ///
    /// # Panics
    /// Where a trial or `progress` does.
    pub fn run_until<T: Trial + Send, E: Send>(
        &self,
        cancelled: &AtomicBool,
        trials: &[u64],
        set_up: impl Fn(usize) -> Result<T, E> + Sync,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Vec<CellStatistics>, SweepError<E>> {
        let blocks = Blocks::new(trials, set_up, cancelled)?;
        let statistics = self.install(|| blocks.run(progress));
        let failed = blocks.failed.into_inner();
        match failed.unwrap_or_else(PoisonError::into_inner) {
            Some((_, error)) => Err(SweepError::SetUp(error)),
            None if cancelled.load(Ordering::Relaxed) => Err(SweepError::Cancelled),
            None => Ok(statistics),
        }
    }

    /// Checks each of so many things on these threads; tells the error of the first that is wrong.
    ///
    /// ```
    /// use palpate_sweep::{RunOptions, Runner};
    ///
    /// let runner = Runner::new(&RunOptions::default())?;
    /// let is_small = |number: usize| if number < 7 { Ok(()) } else { Err(number) };
    /// assert_eq!(runner.check(7, is_small), Ok(()));
    /// assert_eq!(runner.check(100, is_small), Err(7));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Error of the first.
    pub fn check<E: Send>(
        &self,
        count: usize,
        check: impl Fn(usize) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        let all = || (0..count).into_par_iter();
        let error = self.install(|| all().find_map_first(|one| check(one).err()));
        error.map_or(Ok(()), Err)
    }

    /// Does work on these threads.
    pub(crate) fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
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
struct Blocks<'a, T, E, F> {
    /// Trials of each cell.
    trials: &'a [u64],
    /// First block of each cell.
    starts: Vec<u64>,
    blocks: u64,
    alive: Alive<T, F>,
    cancelled: &'a AtomicBool,
    is_failed: AtomicBool,
    /// First cell, of those that were tried, that could not be set up.
    failed: Mutex<Option<(usize, E)>>,
}

impl<'a, T, E, F> Blocks<'a, T, E, F>
where
    T: Trial + Send,
    E: Send,
    F: Fn(usize) -> Result<T, E> + Sync,
{
    fn new(trials: &'a [u64], set_up: F, cancelled: &'a AtomicBool) -> Result<Self, SweepError<E>> {
        let all = trials
            .iter()
            .try_fold(0_u64, |all, &one| all.checked_add(one));
        all.ok_or(SweepError::TooManyTrials {
            cells: trials.len(),
        })?;
        let mut starts = Vec::with_capacity(trials.len());
        let mut all_blocks = 0;
        for &trials in trials {
            starts.push(all_blocks);
            all_blocks += blocks(trials);
        }
        Ok(Self {
            trials,
            starts,
            blocks: all_blocks,
            alive: Alive::new(trials, set_up),
            cancelled,
            is_failed: AtomicBool::new(false),
            failed: Mutex::new(None),
        })
    }

    /// Runs all blocks in waves; after each only the folded sums of the cell that is not complete remain.
    fn run(&self, progress: &(dyn Fn(u64) + Sync)) -> Vec<CellStatistics> {
        let wave = blocks_of_wave(rayon::current_num_threads());
        let mut all = Segment::default();
        for start in (0..self.blocks).step_by(wave as usize) {
            let blocks = (self.blocks - start).min(wave) as usize;
            all = all.join(self.run_wave(start, blocks, progress), self.trials);
            all.fold();
        }
        all.into_statistics()
    }

    fn run_wave(&self, start: u64, blocks: usize, progress: &(dyn Fn(u64) + Sync)) -> Segment {
        let run = |(mut segment, mut workspace): (Segment, Workspace), index: usize| {
            self.run_block(&mut segment, &mut workspace, start + index as u64, progress);
            (segment, workspace)
        };
        (0..blocks)
            .into_par_iter()
            .with_max_len(blocks_of_job(blocks as u64, rayon::current_num_threads()) as usize)
            .fold(Default::default, run)
            .map(|(segment, _)| segment)
            .reduce(Segment::default, |left, right| {
                left.join(right, self.trials)
            })
    }

    /// Runs a block of those of all cells, unless the run is over.
    fn run_block(
        &self,
        segment: &mut Segment,
        workspace: &mut Workspace,
        index: u64,
        progress: &(dyn Fn(u64) + Sync),
    ) {
        let is_over = |flag: &AtomicBool| flag.load(Ordering::Relaxed);
        if is_over(self.cancelled) || is_over(&self.is_failed) {
            return;
        }
        let number = self.starts.partition_point(|&first| first <= index) - 1;
        let block = index - self.starts[number];
        let trial = match self.alive.get(number) {
            Ok(trial) => trial,
            Err(error) => return self.fail(number, error),
        };
        let cell = Cell {
            trials: self.trials[number],
            trial: &*trial,
        };
        segment.run_block((number, block), &cell, workspace, self.cancelled);
        self.alive.finish_block(number);
        progress((cell.trials - block * BLOCK).min(BLOCK));
    }

    fn fail(&self, cell: usize, error: E) {
        self.is_failed.store(true, Ordering::Relaxed);
        let mut failed = self.failed.lock().unwrap_or_else(PoisonError::into_inner);
        if failed.as_ref().is_none_or(|(known, _)| cell < *known) {
            *failed = Some((cell, error));
        }
    }
}
