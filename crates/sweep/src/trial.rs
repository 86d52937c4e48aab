//! Experiments that are repeated, and the cells of a study that repeat them.

use std::ops::Range;

use crate::record::Record;

/// Trials in a block, the unit of work. The sums of the blocks of a cell are folded in their order.
pub const BLOCK: u64 = 1024;

/// An experiment that is repeated in a cell.
pub trait Trial: Sync {
    /// Number of quantities that it observes.
    fn quantities(&self) -> usize;

    /// Runs one trial, which must depend on nothing but its number, and records what it says of the quantities.
    ///
    /// # Errors
    /// The stable kebab-case name of the kind of failure. Nothing that the trial recorded is kept.
    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str>;

    /// Runs some of the first of `trials` together, records what they say as [`Trial::run`] would, to the last bit, and
    /// tells how many they were. All of them succeeded: what is left is run one by one until this goes on.
    ///
    /// For trials that are quicker side by side; by default there are none.
    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        let _ = (trials, record);
        0
    }

    /// Whether its trials differ; one trial tells everything of an experiment that is not random.
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

/// One setting of a study: a trial and how often to run it, with the numbers `0..trials`.
#[derive(Clone, Copy)]
pub struct Cell<'a> {
    /// Number of trials; may be 0.
    pub trials: u64,
    /// The experiment.
    pub trial: &'a dyn Trial,
}
