//! Answer of a design: which values of a field meet the target, and the trials that say so.

use palpate_study::{Bound, Quantity, Target};
use palpate_sweep::{EndReason, Run, Side};

use super::field::Field;

/// Values of a field that meet a target, and those that miss it.
///
/// Values between [`Answer::runs`] are undecided. Between values that were looked at, a curve may do what nobody saw.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Field that was varied.
    pub field: Field,
    /// Target, with its quantity.
    pub target: Target,
    /// Unit of the target's statistic, as in `cells.csv`.
    pub unit: &'static str,
    /// Largest share of the trials that may fail.
    pub max_failures: f64,
    /// Probability that all of the answer is right.
    pub confidence: f64,
    /// Columns of the swept fields that tell the cells apart which meet the target together.
    pub columns: Vec<String>,
    /// Values of these fields in each cell, as results show them.
    pub cells: Vec<Vec<String>>,
    /// Values that were looked at, ascending; of listed values, in the order of the list.
    pub looked: Vec<LookedAt>,
    /// Neighbouring values on one side, ascending; of listed values, their places.
    pub runs: Vec<Run>,
    /// Number of ends of runs that fresh trials did not verify where the search had found them, so that the answer is
    /// narrower there.
    pub narrowed: usize,
    /// Reason why the search ended.
    pub ended: EndReason,
}

/// Value that was looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct LookedAt {
    /// The value; of listed values, its place.
    pub value: f64,
    /// Side on which it lies by the answer; `None`: undecided.
    pub side: Option<Side>,
    /// Cell that meets the target least surely, or misses it most surely.
    pub worst: usize,
    /// Trials of each cell that the search saw, in the order of the cells.
    pub searched: Vec<Sample>,
    /// Trials by which it was verified, as far as it was.
    pub fresh: Vec<Sample>,
}

/// Trials of a cell at a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The cell.
    pub cell: usize,
    /// Trials run; 0 where the readings can tell nothing.
    pub trials: u64,
    /// Number of them that failed.
    pub failed: u64,
    /// The target's statistic and its standard error; `None` where it is undefined.
    pub statistic: Option<(f64, f64)>,
}

impl Sample {
    /// Share of the trials that failed; 1 where the readings can tell nothing.
    pub fn failing(&self) -> f64 {
        match self.trials {
            0 => 1.0,
            trials => self.failed as f64 / trials as f64,
        }
    }
}

impl LookedAt {
    /// The sample of the cell that matters most: the one of which the most trials fail if too many do, else the one whose
    /// statistic is furthest on the wrong side.
    pub fn decisive(&self, bound: Bound, max_failures: f64) -> Option<&Sample> {
        let failing = |sample: &&Sample| sample.failing() > max_failures;
        let by_failures =
            |one: &&Sample, other: &&Sample| one.failing().total_cmp(&other.failing());
        if let Some(failing) = self.searched.iter().filter(failing).max_by(by_failures) {
            return Some(failing);
        }
        let far = |sample: &Sample| {
            let value = sample.statistic.map_or(0.0, |(value, _)| value);
            match bound {
                Bound::AtMost => value,
                Bound::AtLeast => -value,
            }
        };
        let told = self
            .searched
            .iter()
            .filter(|sample| sample.statistic.is_some());
        told.max_by(|one, other| far(one).total_cmp(&far(other)))
    }
}

impl Answer {
    /// Quantity of the target.
    pub fn quantity(&self) -> Option<Quantity> {
        self.target.quantity
    }

    /// Runs of values that meet the target, or miss it.
    pub fn on(&self, side: Side) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(move |run| run.side == side)
    }

    /// All samples of all values.
    pub(crate) fn samples(&self) -> impl Iterator<Item = &Sample> {
        let both = self
            .looked
            .iter()
            .flat_map(|looked| [&looked.searched, &looked.fresh]);
        both.flatten()
    }

    /// Value that comes nearest to the target, and the sample of its worst cell: the best statistic of values of which few
    /// enough trials fail, else the fewest failures.
    pub fn best(&self) -> Option<(&LookedAt, &Sample)> {
        let all = || {
            let of = |looked: &'_ LookedAt| {
                looked
                    .decisive(self.target.bound, self.max_failures)
                    .copied()
            };
            self.looked
                .iter()
                .filter_map(move |looked| Some((looked, of(looked)?)))
        };
        let few = |sample: &Sample| sample.failing() <= self.max_failures;
        let sign = match self.target.bound {
            Bound::AtMost => 1.0,
            Bound::AtLeast => -1.0,
        };
        let statistic = |sample: &Sample| sample.statistic.map(|(value, _)| sign * value);
        let sound = all().filter_map(|(looked, sample)| {
            Some((looked, statistic(&sample).filter(|_| few(&sample))?))
        });
        let best = sound.min_by(|one, other| one.1.total_cmp(&other.1));
        let failing = all().map(|(looked, sample)| (looked, sample.failing()));
        let least = failing.min_by(|one, other| one.1.total_cmp(&other.1));
        let (looked, _) = best.or(least)?;
        Some((
            looked,
            looked.decisive(self.target.bound, self.max_failures)?,
        ))
    }
}
