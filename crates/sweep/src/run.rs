//! The runner.

use std::convert::Infallible;
use std::error::Error as _;
use std::io;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

use rayon::prelude::*;
use thiserror::Error;

use crate::partial::Partial;
use crate::stream::Sweep;
use crate::summary::CellStatistics;
use crate::task::Task;
use crate::trial::{Cell, Trial};

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
        let all = trials
            .iter()
            .try_fold(0_u64, |all, &one| all.checked_add(one));
        all.ok_or(SweepError::TooManyTrials {
            cells: trials.len(),
        })?;
        let mut starts = Vec::with_capacity(trials.len());
        let mut tasks = 0;
        for &trials in trials {
            starts.push(tasks);
            tasks += Task::superblocks(trials);
        }
        let cells = Cells {
            trials,
            starts,
            tasks,
            set_up,
        };
        let mut statistics: Vec<CellStatistics> = Vec::with_capacity(trials.len());
        let mut open = Partial::default();
        self.stream(&cells, cancelled, progress, &mut |number, partial| {
            open.merge(partial);
            let next_cell = cells.starts.get(statistics.len() + 1).unwrap_or(&tasks);
            if number + 1 == *next_cell {
                statistics.push(std::mem::take(&mut open).statistics());
            }
            ControlFlow::Continue(())
        })?;
        Ok(statistics)
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

    /// Whether there are threads, and with them a clock.
    pub(crate) fn has_threads(&self) -> bool {
        self.pool.is_some()
    }

    /// Does the same work on every thread.
    pub(crate) fn everywhere(&self, work: impl Fn() + Sync) {
        match &self.pool {
            Some(pool) => {
                pool.broadcast(|_| work());
            }
            None => work(),
        }
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

/// Cells whose statistics are kept, all of them.
struct Cells<'a, F> {
    /// Trials of each cell.
    trials: &'a [u64],
    /// First task of each cell.
    starts: Vec<u64>,
    tasks: u64,
    set_up: F,
}

impl<T: Trial + Send, E: Send, F: Fn(usize) -> Result<T, E> + Sync> Sweep for Cells<'_, F> {
    type Trial = T;
    type Result = Partial;
    type Error = E;

    fn tasks(&self) -> u64 {
        self.tasks
    }

    fn task(&self, number: u64) -> Task {
        let cell = self.starts.partition_point(|&first| first <= number) - 1;
        Task::of(cell, self.trials[cell], number - self.starts[cell])
    }

    fn set_up(&self, cell: usize) -> Result<T, E> {
        (self.set_up)(cell)
    }

    fn finish(&self, _task: &Task, _trial: &T, partial: Partial) -> Partial {
        partial
    }
}
