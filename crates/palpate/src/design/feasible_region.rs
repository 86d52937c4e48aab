//! Answer of a design: the values of several fields that, taken together, meet a target, and the trials behind it.

use palpate_study::{Bound, Target};
use palpate_sweep::{EndReason, Run, Side};

use super::field::Field;
use super::question::{Extreme, Sought};

/// Values of one or several fields that, taken together, meet a target.
///
/// Values between [`RegionColumn::runs`] are undecided. Between tried values nothing was observed.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Fields of the grid; none if a single field is varied.
    pub grid: Vec<Field>,
    /// Field that is searched at each combination of the grid's values.
    pub searched: Field,
    /// Target, with its quantity.
    pub target: Target,
    /// Unit of the target's statistic, as in `cells.csv`.
    pub unit: &'static str,
    /// Largest share of the trials that may fail.
    pub max_failures: f64,
    /// Columns of the other swept fields. All their cells must meet the target together.
    pub cell_columns: Vec<String>,
    /// Values of these fields in each cell, as the tables show them.
    pub cells: Vec<Vec<String>>,
    /// Combinations of the grid's values in ascending order, with the result at each; at least one.
    pub columns: Vec<RegionColumn>,
    /// Field whose best value was wanted.
    pub sought: Option<Sought>,
    /// Probability that the results at all combinations are right.
    pub confidence: f64,
}

/// Combination of the grid's values, and the values of the searched field that meet the target there.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionColumn {
    /// Value of each field of the grid; of listed values, the index.
    pub at: Vec<f64>,
    /// Tried values, ascending; listed values in the order of the list.
    pub points: Vec<DesignPoint>,
    /// Neighbouring values on one side, ascending; of listed values, their indices.
    pub runs: Vec<Run>,
    /// Number of ends of runs that fresh trials did not verify, so that the answer is narrower there.
    pub narrowed: usize,
    /// Reason why the search ended.
    pub ended: EndReason,
}

/// Tried value of the searched field.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignPoint {
    /// The value; of listed values, its index.
    pub value: f64,
    /// Side of the target; `None`: undecided.
    pub side: Option<Side>,
    /// Cell that meets the target with the least certainty, or misses it with the greatest.
    pub worst: usize,
    /// Trials of each cell that the search used, in the order of the cells.
    pub searched: Vec<Sample>,
    /// Trials that verify the answer, if any.
    pub fresh: Vec<Sample>,
}

/// Trials of a cell at a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The cell.
    pub cell: usize,
    /// Number of trials; 0 if nothing can be estimated from the readings.
    pub trials: u64,
    /// Number of failed trials.
    pub failed: u64,
    /// The target's statistic and its standard error; `None` if it is undefined.
    pub statistic: Option<(f64, f64)>,
}

/// Best value of the sought field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best<'a> {
    /// The value; of listed values, the index.
    pub value: f64,
    /// Column in which it meets the target.
    pub column: &'a RegionColumn,
    /// Value of the searched field; of listed values, the index.
    pub searched: f64,
}

impl Sample {
    /// Share of the trials that failed; 1 if nothing can be estimated from the readings.
    pub fn failure_rate(&self) -> f64 {
        match self.trials {
            0 => 1.0,
            trials => self.failed as f64 / trials as f64,
        }
    }
}

impl DesignPoint {
    /// The sample of the decisive cell: if too many trials fail in some cell, the one with the largest share of failures,
    /// else the one whose statistic is furthest on the wrong side.
    pub fn decisive(&self, bound: Bound, max_failures: f64) -> Option<&Sample> {
        let failing = |sample: &&Sample| sample.failure_rate() > max_failures;
        let by_failures =
            |one: &&Sample, other: &&Sample| one.failure_rate().total_cmp(&other.failure_rate());
        if let Some(failing) = self.searched.iter().filter(failing).max_by(by_failures) {
            return Some(failing);
        }
        let with_statistic = self.searched.iter().filter_map(|sample| {
            let (value, _) = sample.statistic?;
            Some((sample, miss_distance(value, bound)))
        });
        let furthest = with_statistic.max_by(|one, other| one.1.total_cmp(&other.1));
        furthest.map(|(sample, _)| sample)
    }
}

/// Statistic with the sign that makes the worse value larger.
fn miss_distance(statistic: f64, bound: Bound) -> f64 {
    match bound {
        Bound::AtMost => statistic,
        Bound::AtLeast => -statistic,
    }
}

/// Value that comes nearest to a target, with its column and its decisive sample: the best statistic of the values with few
/// enough failures, else the fewest failures.
pub(super) fn nearest<'a>(
    columns: impl IntoIterator<Item = &'a RegionColumn>,
    bound: Bound,
    max_failures: f64,
) -> Option<(&'a RegionColumn, &'a DesignPoint, &'a Sample)> {
    let points = columns
        .into_iter()
        .flat_map(|column| column.points.iter().map(move |point| (column, point)));
    let all = points.filter_map(|(column, point)| {
        let sample = point.decisive(bound, max_failures)?;
        Some((column, point, sample))
    });
    let rank = |sample: &Sample| match sample.statistic {
        Some((value, _)) if sample.failure_rate() <= max_failures => {
            (0, miss_distance(value, bound))
        }
        _ => (1, sample.failure_rate()),
    };
    all.min_by(|one, other| {
        let (one, other) = (rank(one.2), rank(other.2));
        one.0.cmp(&other.0).then(one.1.total_cmp(&other.1))
    })
}

impl RegionColumn {
    /// Runs of values that meet the target, or miss it.
    pub fn on(&self, side: Side) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(move |run| run.side == side)
    }

    /// All samples of all values.
    pub(super) fn samples(&self) -> impl Iterator<Item = &Sample> {
        let points = self.points.iter();
        points.flat_map(|point| point.searched.iter().chain(&point.fresh))
    }
}

impl Region {
    /// Whether a single field is varied and all its values are wanted: then the answer is a curve, without a grid.
    pub fn is_curve(&self) -> bool {
        self.grid.is_empty() && self.sought.is_none()
    }

    /// Field whose best value was wanted, with its place in the grid; `None`: it is the searched one.
    pub(super) fn sought_field(&self, sought: &Sought) -> (&Field, Option<usize>) {
        match self.grid.iter().position(|field| field.path == sought.path) {
            Some(place) => (&self.grid[place], Some(place)),
            None => (&self.searched, None),
        }
    }

    /// Best value of the sought field that certainly meets the target; `None` if there is none, or no field is sought.
    pub fn best(&self) -> Option<Best<'_>> {
        let sought = self.sought.as_ref()?;
        let (field, place) = self.sought_field(sought);
        let number = |value: f64| field.number(value).unwrap_or(value);
        let mut best: Option<Best<'_>> = None;
        for column in &self.columns {
            for run in column.on(Side::Meets) {
                let end = match sought.extreme {
                    Extreme::Largest => run.to,
                    Extreme::Smallest => run.from,
                };
                let (value, searched) = match place {
                    Some(place) => (column.at[place], run.from),
                    None => (end, end),
                };
                let is_better = best
                    .is_none_or(|best| sought.extreme.prefers(number(value), number(best.value)));
                if is_better {
                    best = Some(Best {
                        value,
                        column,
                        searched,
                    });
                }
            }
        }
        best
    }

    /// Value from which on every value misses the target in every column, in the sought direction; `None` if this is open
    /// in some column, or if the sought field is not a searched range.
    pub(super) fn missed_from(&self) -> Option<f64> {
        let sought = self.sought.as_ref()?;
        if self.searched.is_listed() || self.sought_field(sought).1.is_some() {
            return None;
        }
        let span = self.searched.span;
        let missed_from = |column: &RegionColumn| {
            let mut misses = column.on(Side::Misses);
            match sought.extreme {
                Extreme::Largest => misses.find(|run| run.to == span.to).map(|run| run.from),
                Extreme::Smallest => misses.find(|run| run.from == span.from).map(|run| run.to),
            }
        };
        let ends: Option<Vec<f64>> = self.columns.iter().map(missed_from).collect();
        ends?.into_iter().reduce(match sought.extreme {
            Extreme::Largest => f64::max,
            Extreme::Smallest => f64::min,
        })
    }

    /// Value that comes nearest to the target, with its column and its decisive sample: the best statistic of the values
    /// with few enough failures, else the fewest failures.
    pub fn nearest(&self) -> Option<(&RegionColumn, &DesignPoint, &Sample)> {
        nearest(&self.columns, self.target.bound, self.max_failures)
    }

    /// [`Region::nearest`] of one column.
    pub(super) fn nearest_in<'a>(
        &self,
        column: &'a RegionColumn,
    ) -> Option<(&'a DesignPoint, &'a Sample)> {
        let (_, point, sample) = nearest([column], self.target.bound, self.max_failures)?;
        Some((point, sample))
    }
}
