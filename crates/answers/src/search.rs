//! Searches for the values of a field at which a target is met. Each test of a value runs random trials and returns a
//! score: the number of standard errors by which the target is met. The score is noisy, because the trials are random.
//!
//! The trials at all values use the same random numbers. The answer is verified with fresh trials. The probability that
//! any decision of a search is wrong is at most [`Search::wrong`]. One fifth of this probability is divided evenly
//! among at most 400 tests of values. The rest is divided evenly among the ends of the ranges in the answer. The search
//! makes up to five attempts to verify an end. The probability that an attempt confirms a wrong end is half as large as
//! for the previous attempt. These probabilities do not depend on how the score varies with the value. However, if the
//! target is met, then missed and met again between two tested values, the search does not detect this.

mod explore;
mod limits;
mod points;
mod span;
mod verify;

use std::time::Duration;

use palpate_report::Stretch;
use palpate_sweep::Clock;

use limits::{Effort, Rules};

pub(crate) use explore::EndReason;
pub(crate) use explore::SearchRange;
pub(crate) use points::Side;
pub(crate) use span::Span;

/// Scores of one cell of the study for the two conditions of a target. A score is the number of standard errors by
/// which the condition is met; it is negative if the condition is missed. The first condition limits the statistic, the
/// second limits the share of trials that fail.
pub(crate) type Scores = [f64; 2];

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScoreRequest {
    /// Value of the searched field. For listed values, it is the index in the list.
    pub(crate) value: f64,
    /// Index of the cell. All cells must meet the target. A cell is a combination of the values that the study sweeps.
    pub(crate) cell: usize,
    /// Smallest number of trials from which the scores must be computed.
    pub(crate) trials: u64,
    /// Whether the trials must be fresh, that is, trials that this search has not used before.
    pub(crate) fresh: bool,
}

/// Computes the scores of the cells of the study. A score is the number of standard errors by which a cell meets the
/// target. For each cell, the score as a function of the searched field is a curve.
///
/// A trial must draw the same random numbers at every value, so that values can be compared trial by trial.
pub(crate) trait Curves {
    /// Type of error if a score cannot be computed.
    type Error;

    /// Number of cells of the study, at least 1. All cells must meet the target.
    fn cells(&self) -> usize;

    /// Computes one pair of scores for each request, in the order of the requests.
    ///
    /// # Errors
    /// Reason why a score cannot be computed.
    fn scores(&mut self, requests: &[ScoreRequest]) -> Result<Vec<Scores>, Self::Error>;
}

/// Settings of a search for values that meet a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Search {
    /// Range or list of the values that the search may test.
    pub(crate) among: SearchRange,
    /// Largest gap that may remain between values that meet the target and values that miss it. It is measured by
    /// [`Span::gap`].
    pub(crate) gap: f64,
    /// Largest number of trials of each cell of the study at one value of the searched field.
    pub(crate) most_trials: u64,
    /// Time after which the search tests no more values. The first scan (17 values in the range) and the verification
    /// of the answer are always done.
    pub(crate) budget: Option<Duration>,
    /// Largest accepted probability that any part of the answer is wrong. It should be above 0 and below 1. For 0, a
    /// negative value or NaN, the answer is empty, because no decision can be certain enough. A value above 1 is
    /// treated as 1.
    pub(crate) wrong: f64,
}

/// Result of a search: the values that meet the target, and the values that miss it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SearchResult {
    /// Tested values of the searched field, in ascending order.
    pub(crate) tested: Vec<TestedValue>,
    /// Ranges of neighbouring values that all meet or all miss the target, in ascending order. It is undecided whether
    /// values between two ranges meet the target.
    pub(crate) runs: Vec<Stretch>,
    /// Number of range ends that fresh trials (trials that the search has not used) did not confirm at the first
    /// attempt. Each such end was moved inwards, or its range was dropped.
    pub(crate) narrowed: usize,
    pub(crate) ended: EndReason,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TestedValue {
    pub(crate) value: f64,
    /// Whether the value meets or misses the target; `None` if the tests have not decided this.
    pub(crate) side: Option<Side>,
    /// Index of the cell of the study that has the smallest score at this value, that is, the cell that meets the
    /// target least clearly or misses it most clearly.
    pub(crate) worst: usize,
    /// Largest number of trials that a cell of the study has at this value.
    pub(crate) trials: u64,
}

/// Searches for the values of a field at which all cells of the study meet the target.
///
/// Without a time budget, the result depends only on the scores.
///
/// # Errors
/// The error of `curves`, if a score cannot be computed.
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
