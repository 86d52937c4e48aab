//! Search for the values of a field at which a target is met, through noise, and how sure the answer is.
//!
//! Every score below is of trials that draw the same random numbers at every value. What fresh trials must verify is
//! verified as surely as is asked for, all looks and attempts together: a fifth of the probability to be wrong is for the looks of the search
//! (shared evenly by at most 400), the rest for the ends of the runs, where each attempt has half the probability of the one
//! before. So it holds whatever the curve is like; only between values that were looked at it may do what nobody saw.

mod curve;
mod effort;
mod explore;
mod points;
mod rules;
mod span;
mod verify;

use std::time::Duration;

use crate::plan::Clock;
use effort::Effort;
use rules::Rules;

pub use curve::{Ask, Curves, Scores};
pub use explore::{Among, Ended};
pub use points::Side;
pub use span::Span;
pub use verify::Run;

/// Search for values that meet a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Values among which is searched.
    pub among: Among,
    /// Largest gap that is to stay between values that meet the target and values that miss it, as [`Span::gap`] has it.
    pub gap: f64,
    /// Most trials of a cell at one value.
    pub most_trials: u64,
    /// Time after which nothing more is explored; the scan and the verification are always done.
    pub budget: Option<Duration>,
    /// Probability that anything which the search claims is wrong; above 0 and below 1. Of 0, of less and of NaN nothing is
    /// claimed; more than 1 is 1.
    pub wrong: f64,
}

/// Values that meet a target, and those that miss it.
#[derive(Clone, Debug, PartialEq)]
pub struct Searched {
    /// Values that were looked at, ascending.
    pub looked: Vec<Looked>,
    /// Neighbouring values on one side, ascending; what is between runs is undecided.
    pub runs: Vec<Run>,
    /// Number of ends of runs that fresh trials did not verify where the search had found them: they were moved, or the run
    /// was given up.
    pub narrowed: usize,
    /// Reason why it ended.
    pub ended: Ended,
}

/// Value that was looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Looked {
    /// The value.
    pub value: f64,
    /// Side on which the search found it; `None`: open.
    pub side: Option<Side>,
    /// Cell that meets the target least surely, or misses it most surely.
    pub worst: usize,
    /// Most trials of a cell.
    pub trials: u64,
}

/// Searches for the values at which all cells of a curve meet their target.
///
/// Without a budget the result hangs on nothing but the scores.
///
/// ```
/// use std::convert::Infallible;
/// use std::time::Duration;
/// use palpate_sweep::{Among, Ask, Curves, Ended, Scores, Search, Side, Span, search};
///
/// /// Meets its target below 1, and scores more with more trials.
/// struct BelowOne;
/// impl Curves for BelowOne {
///     type Error = Infallible;
///     fn cells(&self) -> usize { 1 }
///     fn look(&mut self, asked: &[Ask]) -> Result<Vec<Scores>, Infallible> {
///         let score = |ask: &Ask| [(1.0 - ask.value) * (ask.trials as f64).sqrt(), 40.0];
///         Ok(asked.iter().map(score).collect())
///     }
/// }
/// let among = Among::Span(Span::new(0.1, 10.0, false));
/// let search_it = Search { among, gap: 0.05, most_trials: 1 << 24, budget: None, wrong: 0.05 };
/// let found = search(&mut BelowOne, &search_it, &|| Duration::ZERO)?;
/// assert!(found.looked.len() > 16 && found.ended == Ended::Known);
/// let [meets, misses] = found.runs[..] else { panic!("one crossing") };
/// assert_eq!((meets.from, meets.side, misses.to, misses.side), (0.1, Side::Meets, 10.0, Side::Misses));
/// assert!(meets.to < 1.0 && misses.from > 1.0 && misses.from / meets.to < 1.05);
/// # Ok::<(), Infallible>(())
/// ```
///
/// # Errors
/// That of the curve.
pub fn search<C: Curves + ?Sized>(
    curves: &mut C,
    search: &Search,
    clock: &Clock<'_>,
) -> Result<Searched, C::Error> {
    let rules = Rules::new(search.gap, search.most_trials, search.wrong, curves.cells());
    let mut effort = Effort::new(clock, search.budget);
    let (points, ended) = explore::explore(curves, search.among, &rules, &mut effort)?;
    let (runs, narrowed) = verify::verify(curves, &points, search.among, &rules, &mut effort)?;
    let looked = points.points.iter().map(|point| Looked {
        value: point.value,
        side: point.side(&rules),
        worst: point.worst().0,
        trials: point.trials(),
    });
    Ok(Searched {
        looked: looked.collect(),
        runs,
        narrowed,
        ended,
    })
}
