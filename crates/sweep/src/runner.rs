//! The threads of a run.

use std::convert::Infallible;
use std::error::Error as _;
use std::io;
use std::num::NonZeroUsize;

use rayon::prelude::*;
use thiserror::Error;

/// Settings that must not change results.
#[derive(Clone, Copy, Debug, Default)]
pub struct RunOptions {
    /// Worker threads; by default one per processor.
    pub threads: Option<NonZeroUsize>,
    /// Whether blocks of trials are run whole, however long they take: then no clock is read, and what a thread runs hangs
    /// on nothing but the number of threads.
    pub whole_blocks: bool,
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

/// The threads of a run, for one after another.
#[derive(Debug)]
pub struct Runner {
    /// None where there are no threads: the calling one does the work.
    pool: Option<rayon::ThreadPool>,
    whole_blocks: bool,
}

impl Runner {
    /// Starts the threads. On platforms that have none, such as WebAssembly, the calling thread does the work.
    ///
    /// # Errors
    /// [`NoThreads`].
    pub fn new(options: &RunOptions) -> Result<Self, NoThreads> {
        let RunOptions {
            threads,
            whole_blocks,
        } = *options;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.map_or(0, NonZeroUsize::get))
            .build();
        match pool {
            Ok(pool) => Ok(Self {
                pool: Some(pool),
                whole_blocks,
            }),
            Err(source) if has_no_threads(&source) => Ok(Self {
                pool: None,
                whole_blocks,
            }),
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

    /// Does something for each number below `count` on these threads; gives what came of it, in the order of the numbers.
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

    /// Whether time may be measured: where there are no threads, there need not be a clock.
    pub(crate) fn has_clock(&self) -> bool {
        self.pool.is_some() && !self.whole_blocks
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
