//! Runs cells on worker threads.

use std::convert::Infallible;
use std::error::Error as _;
use std::io;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use rayon::prelude::*;
use thiserror::Error;

use crate::cell::{Cell, Task, Trial};
use crate::stream::{Sweep, SweepOutput};
use crate::summary::CellStatistics;

/// Function that returns the time since a computation began. The time must increase from call to call. Some
/// measurements are repeated until enough time has passed; if the function always returned the same time, they would
/// never end.
pub type Clock<'a> = dyn Fn() -> Duration + 'a;

/// Settings of a run. These settings do not change the results of the run.
#[derive(Clone, Copy, Debug, Default)]
pub struct RunOptions {
    /// Number of worker threads; by default one per processor.
    pub threads: Option<NonZeroUsize>,
    /// Whether a thread always runs whole blocks of trials. If so, no clock is read, and the sizes of the jobs do not
    /// depend on measured times.
    pub whole_blocks: bool,
}

/// The operating system could not start the threads.
#[derive(Debug, Error)]
#[error("cannot start {} worker threads: {source}", threads.map_or("the default number of".to_owned(), |n| n.to_string()))]
pub struct NoThreads {
    threads: Option<NonZeroUsize>,
    source: rayon::ThreadPoolBuildError,
}

/// Reason why a sweep ended early. `E` is the type of error if a cell cannot be set up.
#[derive(Debug, Error)]
pub enum SweepError<E> {
    /// The operating system could not start the threads.
    #[error(transparent)]
    NoThreads(#[from] NoThreads),
    /// A cell could not be set up. If this happens in several cells, the error of the first of these cells is returned.
    #[error("{0}")]
    SetUp(E),
    /// The caller cancelled the run before all cells were complete.
    #[error("the run was cancelled")]
    Cancelled,
}

/// Worker threads. They can be used for any number of runs, one after another.
#[derive(Debug)]
pub struct Runner {
    /// The thread pool. `None` on a platform without threads; the calling thread then does the work.
    pool: Option<rayon::ThreadPool>,
    whole_blocks: bool,
}

impl Runner {
    /// Starts the threads. On a platform without threads, such as WebAssembly, the calling thread does the work.
    ///
    /// # Errors
    /// [`NoThreads`] if the threads cannot be started.
    pub fn new(options: &RunOptions) -> Result<Self, NoThreads> {
        let threads = options.threads;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.map_or(0, NonZeroUsize::get))
            .build();
        let pool = match pool {
            Ok(pool) => Some(pool),
            Err(source) if has_no_threads(&source) => None,
            Err(source) => return Err(NoThreads { threads, source }),
        };
        let whole_blocks = options.whole_blocks;
        Ok(Self { pool, whole_blocks })
    }

    /// Runs all trials of all cells, and returns the statistics of each cell, in the order of the cells. A thread calls
    /// `progress` each time it has run some trials, with the number of these trials.
    ///
    /// # Panics
    /// Panics if a trial or `progress` panics.
    pub fn run(&self, cells: &[Cell], progress: &(dyn Fn(u64) + Sync)) -> Vec<CellStatistics> {
        let mut all = Vec::with_capacity(cells.len());
        let mut take = |_, output| {
            if let SweepOutput::Result(statistics) = output {
                all.push(statistics);
            }
            ControlFlow::Continue(())
        };
        let never = AtomicBool::new(false);
        // Ignore the result: this run cannot fail, because it is never cancelled and its cells are already set up.
        let _ = self.stream(&Cells(cells), &never, progress, &mut take);
        all
    }

    /// Number of worker threads.
    pub fn threads(&self) -> NonZeroUsize {
        let pool = self.pool.as_ref();
        let threads = pool.map_or(1, rayon::ThreadPool::current_num_threads);
        NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN)
    }

    /// Calls `check` once for each number from 0 to `count` − 1, on the worker threads. If some calls fail, returns the
    /// error of the call with the smallest number.
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
    /// The error of the failed call with the smallest number.
    pub fn check<E: Send>(
        &self,
        count: usize,
        check: impl Fn(usize) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        let all = || (0..count).into_par_iter();
        let error = self.install(|| all().find_map_first(|one| check(one).err()));
        error.map_or(Ok(()), Err)
    }

    /// Calls `of` on the worker threads with the numbers from 0 to `count` − 1. Returns the results in the order of the
    /// numbers.
    ///
    /// ```
    /// use palpate_sweep::{RunOptions, Runner};
    ///
    /// let runner = Runner::new(&RunOptions::default())?;
    /// assert_eq!(runner.map(4, |number| number * number), [0, 1, 4, 9]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn map<R: Send>(&self, count: usize, of: impl Fn(usize) -> R + Sync) -> Vec<R> {
        let all = || (0..count).into_par_iter().with_max_len(1);
        self.install(|| all().map(&of).collect())
    }

    /// Whether the runner may measure times. It may not if threads must run whole blocks
    /// ([`RunOptions::whole_blocks`]), or if the platform has no threads, because such a platform may have no clock.
    pub(crate) fn has_clock(&self) -> bool {
        self.pool.is_some() && !self.whole_blocks
    }

    pub(crate) fn everywhere(&self, work: impl Fn() + Sync) {
        match &self.pool {
            Some(pool) => {
                pool.broadcast(|_| work());
            }
            None => work(),
        }
    }

    /// Calls `work` on one of the worker threads, so that parallel iterators in `work` use all worker threads.
    pub(crate) fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

struct Cells<'a>(&'a [Cell<'a>]);

impl<'a> Sweep for Cells<'a> {
    type Trial = &'a dyn Trial;
    type Result = CellStatistics;
    type Error = Infallible;

    fn tasks(&self) -> u64 {
        self.0.len() as u64
    }

    fn task(&self, number: u64) -> Task {
        let cell = number as usize;
        let trials = self.0[cell].trials;
        Task {
            cell,
            trials,
            may_stop: false,
        }
    }

    fn set_up(&self, cell: usize) -> Result<&'a dyn Trial, Infallible> {
        Ok(self.0[cell].trial)
    }

    fn finish(&self, _: usize, _: &&'a dyn Trial, statistics: CellStatistics) -> CellStatistics {
        statistics
    }
}

/// Whether the error occurs because the platform supports no threads. Any other error means that the operating system
/// could not start a thread.
fn has_no_threads(error: &rayon::ThreadPoolBuildError) -> bool {
    let cause = error
        .source()
        .and_then(|cause| cause.downcast_ref::<io::Error>());
    cause.is_some_and(|cause| cause.kind() == io::ErrorKind::Unsupported)
}
