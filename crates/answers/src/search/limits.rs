//! Limits of a search: the scores that its answer must reach, and its budget of trials and time.

use std::time::Duration;

use palpate_statistics::score_of_tail;
use palpate_sweep::Clock;

/// Share of the error probability for the exploration. The exploration decides the sides of values between verified
/// ends.
const EXPLORATION_SHARE: f64 = 0.2;
/// Largest number of tests of values in a search.
pub(super) const MAX_LOOKS: usize = 400;
/// Number of values in the scan: 16 + 1, so that the ends, the middle, the quarters and so on are among them.
pub(super) const SCANNED: usize = 17;
/// Number of trials of each cell in the first test of a value.
pub(super) const FIRST: u64 = 64;
/// Number of attempts to verify a side.
pub(super) const ATTEMPTS: u32 = 5;
/// Number of trials that verify a side, relative to the number that found it.
pub(super) const FRESH: f64 = 2.0;

/// Scores and numbers of trials that a search requires.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    /// Probability that anything in the answer is wrong.
    wrong: f64,
    /// Largest gap that may stay between values that meet the target and values that miss it.
    pub(super) gap: f64,
    /// Largest number of trials of a cell at one value.
    pub(super) most_trials: u64,
    /// Smallest score of all cells at a value that meets the target.
    pub(super) meets: f64,
    /// Largest score (negative) of one cell and condition at a value that misses the target.
    pub(super) misses: f64,
}

impl Rules {
    pub(super) fn new(gap: f64, most_trials: u64, wrong: f64, cells: usize) -> Self {
        // No score is high enough for a probability of NaN, 0 or less.
        let wrong = if wrong > 0.0 { wrong.min(1.0) } else { 0.0 };
        let of_look = EXPLORATION_SHARE * wrong / MAX_LOOKS as f64;
        let conditions = 2 * cells.max(1);
        Self {
            wrong,
            gap,
            most_trials,
            meets: score_of_tail(of_look),
            misses: -score_of_tail(of_look / conditions as f64),
        }
    }

    /// Score that verifies one of `sides` sides in an attempt. Attempts count from 0; each gets half the error
    /// probability of the attempt before.
    pub(super) fn verifies(&self, sides: usize, attempt: u32) -> f64 {
        let wrong = (1.0 - EXPLORATION_SHARE) * self.wrong / sides.max(1) as f64;
        let half = (0..=attempt).fold(wrong, |wrong, _| 0.5 * wrong);
        score_of_tail(half)
    }
}

/// Time and trials of a search, and its budget.
pub(super) struct Effort<'a> {
    clock: &'a Clock<'a>,
    budget: Option<Duration>,
    /// Time of the last round, and its number of trials.
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

    /// Calls `work`, which runs this many trials, and stores its time.
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

    /// Whether this many trials are expected to end within this share of the budget.
    pub(super) fn allows(&self, trials: u64, share: f64) -> bool {
        self.budget.is_none_or(|budget| {
            let after = (self.clock)().as_secs_f64() + self.seconds(trials);
            after <= share * budget.as_secs_f64()
        })
    }

    /// Share of this many trials that fits into the remaining time, at most 1.
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
