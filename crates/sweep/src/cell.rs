//! Experiments, the cells and tasks that repeat them, and the rule that ends a cell early.

use std::ops::Range;

use crate::partial_statistics::Partial;
use crate::trial_record::Record;

/// Number of trials in a block, the unit of work. The sums of a cell's blocks are added in the order of the blocks.
pub const BLOCK: u64 = 1024;

/// Experiment that a cell repeats.
pub trait Trial: Sync {
    /// Number of quantities that it observes.
    fn quantities(&self) -> usize;

    /// Runs one trial, which must depend only on its number, and records its observations.
    ///
    /// # Errors
    /// The stable kebab-case name of the kind of failure. The observations of a failed trial are dropped.
    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str>;

    /// Runs the first few of `trials` together and returns their number. It records the same bits as [`Trial::run`],
    /// and all these trials must have succeeded. After a return of 0, the next trial is run alone.
    ///
    /// Implement it for trials that run faster side by side. The default implementation returns 0.
    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        let _ = (trials, record);
        0
    }

    /// Whether its trials differ. An experiment that is not random is run once.
    fn is_random(&self) -> bool {
        true
    }
}

impl<T: Trial + ?Sized> Trial for &T {
    fn quantities(&self) -> usize {
        (**self).quantities()
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        (**self).run(trial, record)
    }

    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        (**self).run_together(trials, record)
    }

    fn is_random(&self) -> bool {
        (**self).is_random()
    }
}

/// One setting of a study: an experiment, and the number of its trials.
#[derive(Clone, Copy)]
pub struct Cell<'a> {
    /// Number of trials; may be 0.
    pub trials: u64,
    /// The experiment.
    pub trial: &'a dyn Trial,
}

/// Unit of a sweep: all trials of one cell, whose statistics become one result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Task {
    /// The cell.
    pub cell: usize,
    /// Number of its trials, or the largest number if a rule may end the cell earlier; may be 0.
    pub trials: u64,
    /// Whether a rule may end the cell before its last trial. Several threads share the last task of a run, and drop
    /// the trials that they ran beyond its end. One thread runs any other task with a rule.
    pub may_stop: bool,
}

/// Rule that ends the trials of a cell when a statistic is precise enough.
///
/// It is applied after 1, 2, 4, 8 … blocks of trials in the order of their numbers, so that its result depends only on
/// the trials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoppingRule {
    /// Index of the quantity among those of the trial.
    pub quantity: usize,
    /// Statistic of the quantity.
    pub statistic: StoppingStatistic,
    /// Relative standard error at which the cell ends. It follows from the scatter between trials: several observations
    /// of one trial count as one.
    pub relative_standard_error: f64,
    /// Smallest number of trials.
    pub min_trials: u64,
}

/// Statistic that a stopping rule uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoppingStatistic {
    /// Mean of the estimates.
    Mean,
    /// Root of the mean squared error.
    RmsError,
    /// Mean magnitude of the error.
    MeanAbsError,
}

impl StoppingRule {
    /// Whether the trials in `cell` are enough.
    pub(crate) fn is_met(&self, cell: &Partial) -> bool {
        let trials = cell.trials;
        trials.is_multiple_of(BLOCK)
            && (trials / BLOCK).is_power_of_two()
            && trials >= self.min_trials
            && self.is_precise(cell) == Some(true)
    }

    /// Whether the relative standard error is small enough; `None` if it is undefined.
    fn is_precise(&self, cell: &Partial) -> Option<bool> {
        let sums = cell.quantities.get(self.quantity)?.sums();
        let [estimates, magnitudes] = sums.by_trial;
        let (value, std_error) = match self.statistic {
            StoppingStatistic::Mean => (estimates.mean(), estimates.std_of_mean()),
            StoppingStatistic::RmsError => (sums.errors.rms(), sums.squares.std_of_rms()),
            StoppingStatistic::MeanAbsError => (magnitudes.mean(), magnitudes.std_of_mean()),
        };
        let (value, std_error) = (value?.abs(), std_error?);
        Some(std_error == 0.0 || std_error <= self.relative_standard_error * value)
    }
}
