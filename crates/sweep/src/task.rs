//! Units of work of a sweep.

use std::ops::Range;

use crate::trial::SUPERBLOCK;

/// Some consecutive trials of one cell, which are summed up together.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// Cell that they are of.
    pub cell: usize,
    /// Their numbers: within one superblock (see [`SUPERBLOCK`]), from the first of a block to the last of one or of
    /// the cell. May be empty.
    pub trials: Range<u64>,
    /// Whether a rule may end the task before its last trial; it then begins with trial 0, and may be longer than a
    /// superblock. The last task of a run is shared among threads, which may run trials that turn out to be too many and
    /// are dropped; others are run by one thread each.
    pub may_stop: bool,
}

/// Rule by which a cell has had enough trials.
///
/// It is looked at after 1, 2, 4, 8 … blocks of trials, in the order of their numbers, so that it depends on nothing but
/// these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Quantity that is watched, among those of the trial.
    pub quantity: usize,
    /// Statistic that is watched.
    pub statistic: Watched,
    /// Relative standard error at which it is known well enough. It is an error over trials: several observations of
    /// one trial count as one.
    pub relative_standard_error: f64,
    /// Fewest trials.
    pub min_trials: u64,
}

/// Statistic by which a cell is watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watched {
    /// Mean of the estimates.
    Mean,
    /// Root of the mean squared error.
    RmsError,
    /// Mean magnitude of the error.
    MeanAbsError,
}

impl Task {
    /// Number of superblocks of a cell of so many trials; one where it has none.
    pub fn superblocks(trials: u64) -> u64 {
        trials.div_ceil(SUPERBLOCK).max(1)
    }

    /// Task of a superblock of a cell of so many trials.
    ///
    /// ```
    /// use palpate_sweep::{SUPERBLOCK, Task};
    ///
    /// let trials = SUPERBLOCK + 5;
    /// assert_eq!(Task::superblocks(trials), 2);
    /// assert_eq!(Task::of(3, trials, 1).trials, SUPERBLOCK..trials);
    /// ```
    pub fn of(cell: usize, trials: u64, superblock: u64) -> Self {
        let start = superblock.saturating_mul(SUPERBLOCK).min(trials);
        let end = start.saturating_add(SUPERBLOCK).min(trials);
        Self {
            cell,
            trials: start..end,
            may_stop: false,
        }
    }
}
