//! Time that a search takes.

use std::time::Duration;

use crate::plan::Clock;

/// Time and trials that have been spent, and what may be.
pub(super) struct Effort<'a> {
    clock: &'a Clock<'a>,
    budget: Option<Duration>,
    /// Time of the last look, and its trials.
    last: (Duration, u64),
}

impl<'a> Effort<'a> {
    pub(super) fn new(clock: &'a Clock<'a>, budget: Option<Duration>) -> Self {
        Self {
            clock,
            budget,
            last: (Duration::ZERO, 0),
        }
    }

    /// Does what runs so many trials, and notes how long it takes.
    pub(super) fn timed<R>(&mut self, trials: u64, work: impl FnOnce() -> R) -> R {
        if self.budget.is_none() {
            return work();
        }
        let start = (self.clock)();
        let done = work();
        if trials > 0 {
            self.last = ((self.clock)().saturating_sub(start), trials);
        }
        done
    }

    /// Whether so many trials are likely to end within this share of the budget.
    pub(super) fn allows(&self, trials: u64, share: f64) -> bool {
        self.budget.is_none_or(|budget| {
            let after = (self.clock)().as_secs_f64() + self.seconds(trials);
            after <= share * budget.as_secs_f64()
        })
    }

    /// Part of so many trials for which there is time, at most 1.
    pub(super) fn part(&self, trials: u64) -> f64 {
        self.budget.map_or(1.0, |budget| {
            let left = budget.saturating_sub((self.clock)()).as_secs_f64();
            let needed = self.seconds(trials);
            if needed > left { left / needed } else { 1.0 }
        })
    }

    fn seconds(&self, trials: u64) -> f64 {
        let (time, run) = self.last;
        time.as_secs_f64() / run.max(1) as f64 * trials as f64
    }
}
