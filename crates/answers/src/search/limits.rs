//! Limits of a search: how large a score must be for a decision, and how many trials and how much time the search may
//! use. The score of a value states how certainly the value meets the target.

use std::time::Duration;

use palpate_statistics::score_of_tail;
use palpate_sweep::Clock;

/// Share of a search's allowed error probability that its exploration may use. The rest is for the verification of the
/// ends of ranges.
const EXPLORATION_SHARE: f64 = 0.2;
/// Largest number of tests in a search. A test compares the scores at one value with the scores that a decision
/// requires.
pub(super) const MAX_LOOKS: usize = 400;
/// Number of values in the first scan: both ends of the range, and 15 values between them at equal distances.
pub(super) const SCANNED: usize = 17;
/// Number of trials of each cell of the study in the first test of a value.
pub(super) const FIRST: u64 = 64;
/// Largest number of attempts to verify an end of a range of values.
pub(super) const ATTEMPTS: u32 = 5;
/// Number of fresh trials that verify a value, divided by the number of trials from which the search decided whether
/// the value meets the target.
pub(super) const FRESH: f64 = 2.0;

/// Smallest scores that a search requires for its decisions, and other limits of the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    wrong: f64,
    pub(super) gap: f64,
    pub(super) most_trials: u64,
    /// A value meets the target if the scores of all cells of the study are at least this large. A score is the number
    /// of standard errors by which a cell meets the target.
    pub(super) meets: f64,
    /// A value misses the target if a score of at least one cell of the study is at most this negative number, in
    /// standard errors.
    pub(super) misses: f64,
}

impl Rules {
    pub(super) fn new(gap: f64, most_trials: u64, wrong: f64, cells: usize) -> Self {
        // If the allowed error probability is NaN, 0 or negative, use 0. Then no score is high enough, so no value is
        // ever decided.
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

    /// Smallest score of fresh trials that confirms an end of a range in the answer. `sides` is the number of all range
    /// ends in the answer. `attempt` is the number of the attempt, from 0; the allowed probability of an error is
    /// halved with each attempt.
    pub(super) fn verifies(&self, sides: usize, attempt: u32) -> f64 {
        let wrong = (1.0 - EXPLORATION_SHARE) * self.wrong / sides.max(1) as f64;
        let half = (0..=attempt).fold(wrong, |wrong, _| 0.5 * wrong);
        score_of_tail(half)
    }
}

/// The time budget of a search, with the measured speed of its trials.
pub(super) struct Effort<'a> {
    clock: &'a Clock<'a>,
    budget: Option<Duration>,
    /// Duration of the last round of trials, and the round's number of trials.
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

    /// Calls `work`, which runs `trials` trials, and stores the duration of the call.
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

    /// Whether `trials` more trials are expected to end before the share `share` of the time budget is used up.
    pub(super) fn allows(&self, trials: u64, share: f64) -> bool {
        self.budget.is_none_or(|budget| {
            let after = (self.clock)().as_secs_f64() + self.seconds(trials);
            after <= share * budget.as_secs_f64()
        })
    }

    /// Share of the `trials` requested trials that can run in the remaining time budget, at most 1.
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
