//! Rules of a search: how sure its answer is to be, and when it has looked enough.

use palpate_statistics::score_of_tail;

/// Share of the probability to be wrong for what the search itself finds: that each value between those that fresh trials verify lies on the side
/// that it has been found on.
const OF_SEARCH: f64 = 0.2;
/// Most times that a search looks at a value.
pub(super) const MOST_LOOKS: usize = 400;
/// Values that are looked at before a crossing is bracketed; more than 16 by one, so that they are at the ends, the middle,
/// the quarters and so on.
pub(super) const SCANNED: usize = 17;
/// Trials of each cell in the first look at a value.
pub(super) const FIRST: u64 = 64;
/// Attempts to verify a side.
pub(super) const ATTEMPTS: u32 = 5;
/// Trials by which a side is verified, in those that found it.
pub(super) const FRESH: f64 = 2.0;

/// Rules of a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    /// Probability that anything an answer claims is wrong.
    wrong: f64,
    /// Largest gap that may stay between what meets and what misses.
    pub(super) gap: f64,
    /// Most trials of a cell at one value.
    pub(super) most_trials: u64,
    /// Score from which on a value is found to meet the target: all cells have it.
    pub(super) meets: f64,
    /// Score up to which, negative, a value is found to miss it: some cell in some condition has it.
    pub(super) misses: f64,
}

impl Rules {
    pub(super) fn new(gap: f64, most_trials: u64, wrong: f64, cells: usize) -> Self {
        // Nothing is as sure as NaN or less than nothing asks.
        let wrong = if wrong > 0.0 { wrong.min(1.0) } else { 0.0 };
        let of_look = OF_SEARCH * wrong / MOST_LOOKS as f64;
        let conditions = 2 * cells.max(1);
        Self {
            wrong,
            gap,
            most_trials,
            meets: score_of_tail(of_look),
            misses: -score_of_tail(of_look / conditions as f64),
        }
    }

    /// Score that verifies one of so many sides in an attempt, counted from 0; each attempt is half as likely to be wrong as
    /// the one before.
    pub(super) fn verifies(&self, sides: usize, attempt: u32) -> f64 {
        let wrong = (1.0 - OF_SEARCH) * self.wrong / sides.max(1) as f64;
        let half = (0..=attempt).fold(wrong, |wrong, _| 0.5 * wrong);
        score_of_tail(half)
    }
}
