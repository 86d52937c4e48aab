//! Runs whose statistics are all kept.

use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

use crate::runner::{RunOptions, Runner, SweepError};
use crate::stream::{Sweep, Taken};
use crate::summary::CellStatistics;
use crate::task::Task;
use crate::trial::{Cell, Trial};

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

impl Runner {
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
        let mut statistics = Vec::with_capacity(trials.len());
        let cells = Cells { trials, set_up };
        self.stream(&cells, cancelled, progress, &mut |_, taken| {
            if let Taken::Result(cell) = taken {
                statistics.push(cell);
            }
            ControlFlow::Continue(())
        })?;
        Ok(statistics)
    }
}

/// Cells whose statistics are kept, all of them.
struct Cells<'a, F> {
    /// Trials of each cell.
    trials: &'a [u64],
    set_up: F,
}

impl<T: Trial + Send, E: Send, F: Fn(usize) -> Result<T, E> + Sync> Sweep for Cells<'_, F> {
    type Trial = T;
    type Result = CellStatistics;
    type Error = E;

    fn tasks(&self) -> u64 {
        self.trials.len() as u64
    }

    fn task(&self, number: u64) -> Task {
        let cell = number as usize;
        Task {
            cell,
            trials: self.trials[cell],
            may_stop: false,
        }
    }

    fn set_up(&self, cell: usize) -> Result<T, E> {
        (self.set_up)(cell)
    }

    fn finish(&self, _cell: usize, _trial: &T, statistics: CellStatistics) -> CellStatistics {
        statistics
    }
}
