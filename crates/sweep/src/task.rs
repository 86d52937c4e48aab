//! Units of work of a sweep.

use crate::partial::Partial;
use crate::trial::BLOCK;

/// Trials of one cell, which are summed up together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Task {
    /// The cell.
    pub cell: usize,
    /// Number of its trials, or the maximum if a rule may end the cell earlier; may be 0.
    pub trials: u64,
    /// Whether a rule may end the cell before its last trial. Several threads share the last task of a run, and drop
    /// the trials that they ran after its end. Any other task with a rule is run by one thread.
    pub may_stop: bool,
}

/// Rule that ends the trials of a cell when a statistic is precise enough.
///
/// It is applied after 1, 2, 4, 8 … blocks of trials, in the order of their numbers, so that its result depends only
/// on the trials.
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

impl Stop {
    /// Whether the trials in `cell` are enough.
    pub(crate) fn is_met(&self, cell: &Partial) -> bool {
        let trials = cell.trials;
        trials.is_multiple_of(BLOCK)
            && (trials / BLOCK).is_power_of_two()
            && trials >= self.min_trials
            && self.is_known(cell) == Some(true)
    }

    /// Whether the relative standard error is small enough; `None` if it is undefined.
    fn is_known(&self, cell: &Partial) -> Option<bool> {
        let sums = cell.quantities.get(self.quantity)?.sums();
        let [estimates, magnitudes] = sums.by_trial;
        let (value, std_error) = match self.statistic {
            Watched::Mean => (estimates.mean(), estimates.std_of_mean()),
            Watched::RmsError => (sums.errors.rms(), sums.squares.std_of_rms()),
            Watched::MeanAbsError => (magnitudes.mean(), magnitudes.std_of_mean()),
        };
        let (value, std_error) = (value?.abs(), std_error?);
        Some(std_error == 0.0 || std_error <= self.relative_standard_error * value)
    }
}
