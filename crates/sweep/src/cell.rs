//! Defines experiments, the cells and tasks that repeat an experiment in many trials, and the rule that ends the trials
//! of a cell early.

use std::ops::Range;

use crate::partial_statistics::Partial;
use crate::trial_record::Record;

/// Number of trials in a block, the smallest group of trials whose sums are computed together. The sums of a cell's
/// blocks are added in the order of the blocks, so the result does not depend on the threads.
pub(crate) const BLOCK: u64 = 1024;

/// An experiment. A cell of the study repeats it in many trials.
pub trait Trial: Sync {
    /// Number of quantities that the experiment observes.
    fn quantities(&self) -> usize;

    /// Runs one trial and records its observations. The observations must depend only on the number of the trial.
    ///
    /// # Errors
    /// The name of the kind of failure. The name is stable and in kebab case. The observations of a failed trial are
    /// dropped.
    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str>;

    /// Runs some trials together, from the first trial in `trials` on, and returns their number. The function must
    /// record exactly the same numbers as [`Trial::run`], and must run only trials that succeed. If it returns 0, the
    /// next trial is run by [`Trial::run`].
    ///
    /// Implement this function if several trials take less time together than one after the other. The default
    /// implementation returns 0.
    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        let _ = (trials, record);
        0
    }

    /// Whether different trials of the experiment may have different results. If all results are equal, only one trial
    /// is run.
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

/// One grid point of a study: an experiment, and the number of trials that repeat it.
#[derive(Clone, Copy)]
pub struct Cell<'a> {
    /// Number of trials; may be 0.
    pub trials: u64,
    /// The experiment that the trials repeat.
    pub trial: &'a dyn Trial,
}

/// Unit of work of a sweep: all trials of one cell. The statistics of these trials become one result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Task {
    /// Index of the cell.
    pub cell: usize,
    /// Number of trials of the cell; may be 0. If a rule may end the cell early, this is the largest possible number.
    pub trials: u64,
    /// Whether a rule may end the cell before its last trial. All trials of such a task run on one thread. Only the
    /// last task of a run is shared by several threads. These threads may run trials beyond the trial at which the rule
    /// ends the cell; such trials are dropped.
    pub may_stop: bool,
}

/// Rule that ends the trials of a cell when a statistic of a quantity is precise enough.
///
/// The rule is applied after 1, 2, 4, 8 … blocks of 1024 trials, in the order of the trial numbers. Therefore the
/// number of trials of a cell depends only on the results of its trials, not on the number of threads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoppingRule {
    /// Index of the quantity whose statistic is tested. The index is the place of the quantity among the quantities of
    /// the trial.
    pub quantity: usize,
    /// The statistic whose precision is tested.
    pub statistic: StoppingStatistic,
    /// The trials of a cell end when the relative standard error of the statistic is at most this value. The standard
    /// error is computed from the scatter between trials, so the observations within one trial count as a single
    /// observation.
    pub relative_standard_error: f64,
    /// Smallest number of trials after which the rule may end a cell.
    pub min_trials: u64,
}

/// Statistic whose precision a stopping rule tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoppingStatistic {
    /// Mean of the estimates of the quantity.
    Mean,
    /// Root-mean-square error of the estimates.
    RmsError,
    /// Mean absolute error of the estimates.
    MeanAbsError,
}

impl StoppingRule {
    pub(crate) fn is_met(&self, cell: &Partial) -> bool {
        let trials = cell.trials;
        trials.is_multiple_of(BLOCK)
            && (trials / BLOCK).is_power_of_two()
            && trials >= self.min_trials
            && self.is_precise(cell) == Some(true)
    }

    /// Whether the relative standard error of the stopping rule's statistic is small enough; `None` if this error is
    /// undefined.
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
