//! Search for the values of a field at which a target is met, from scores with noise.
//!
//! Scores at all values come from trials with the same random numbers. Fresh trials verify the answer. All steps of a
//! search together are wrong with at most the probability [`Search::wrong`]. One fifth of it is divided evenly among at
//! most 400 tests of values, the rest among the ends of the runs. Each attempt at an end gets half the probability of
//! the attempt before. This holds for any curve. Only between the tested values, the curve may cross the limit
//! unnoticed.

mod explore;
mod limits;
mod points;
mod span;
mod verify;

use std::time::Duration;

use palpate_sweep::Clock;

use limits::{Effort, Rules};

pub use explore::EndReason;
pub(crate) use explore::SearchRange;
pub use points::Side;
pub use span::Span;
pub use verify::Run;

/// Scores of the two conditions of a target in one cell: the number of standard deviations by which the condition is
/// met, negative if it is missed. The first score is for the statistic, the second for the share of trials that fail.
pub(crate) type Scores = [f64; 2];

/// Request for the scores of a cell at a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScoreRequest {
    /// Value of the varied field; for listed values, the index in the list.
    pub(crate) value: f64,
    /// Index of the cell among those that must all meet the target.
    pub(crate) cell: usize,
    /// Smallest number of trials.
    pub(crate) trials: u64,
    /// Whether the trials must be new: not used by this search before.
    pub(crate) fresh: bool,
}

/// Scores of some cells over the values of a field.
///
/// A trial must draw the same random numbers at every value, so that values can be compared trial by trial.
pub(crate) trait Curves {
    /// Reason why a score is missing.
    type Error;

    /// Number of cells that must all meet the target; at least 1.
    fn cells(&self) -> usize;

    /// Scores for some requests, in their order.
    ///
    /// # Errors
    /// Reason why a request has no score.
    fn scores(&mut self, requests: &[ScoreRequest]) -> Result<Vec<Scores>, Self::Error>;
}

/// Settings of a search for values that meet a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Search {
    /// Values that the search may test.
    pub(crate) among: SearchRange,
    /// Largest gap that may stay between values that meet the target and values that miss it, by [`Span::gap`].
    pub(crate) gap: f64,
    /// Largest number of trials of a cell at one value.
    pub(crate) most_trials: u64,
    /// Time after which the search explores no more values; the scan and the verification are always done.
    pub(crate) budget: Option<Duration>,
    /// Probability that any part of the answer is wrong, above 0 and below 1. If it is 0, negative or NaN, the answer
    /// is empty; a value above 1 counts as 1.
    pub(crate) wrong: f64,
}

/// Values that meet a target, and values that miss it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SearchResult {
    /// Values that were tested, ascending.
    pub(crate) tested: Vec<TestedValue>,
    /// Ranges of neighbouring values on one side, ascending; values between the ranges are undecided.
    pub(crate) runs: Vec<Run>,
    /// Number of ends of runs that fresh trials did not verify at the first attempt. Each was moved, or its run was
    /// dropped.
    pub(crate) narrowed: usize,
    /// Reason why the search ended.
    pub(crate) ended: EndReason,
}

/// Value that a search has tested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TestedValue {
    /// The value.
    pub(crate) value: f64,
    /// Side of the target on which it lies; `None` if that is undecided.
    pub(crate) side: Option<Side>,
    /// Cell with the smallest score.
    pub(crate) worst: usize,
    /// Largest number of trials of a cell.
    pub(crate) trials: u64,
}

/// Searches for the values at which all cells of a curve meet their target.
///
/// Without a budget the result depends only on the scores.
///
/// # Errors
/// The error of the curve.
pub(crate) fn search<C: Curves + ?Sized>(
    curves: &mut C,
    search: &Search,
    clock: &Clock<'_>,
) -> Result<SearchResult, C::Error> {
    let rules = Rules::new(search.gap, search.most_trials, search.wrong, curves.cells());
    let mut effort = Effort::new(clock, search.budget);
    let (points, ended) = explore::explore(curves, search.among, &rules, &mut effort)?;
    let (runs, narrowed) = verify::verify(curves, &points, search.among, &rules, &mut effort)?;
    let tested = points.points.iter().map(|point| TestedValue {
        value: point.value,
        side: point.side(&rules),
        worst: point.worst().0,
        trials: point.trials(),
    });
    Ok(SearchResult {
        tested: tested.collect(),
        runs,
        narrowed,
        ended,
    })
}
