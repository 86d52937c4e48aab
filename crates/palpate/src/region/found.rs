//! Feasible region of several fields.

use palpate_study::Bound;
use palpate_sweep::Side;

use super::survey::{Extreme, Sought};
use crate::design::{Answer, Field, LookedAt, Sample};

/// Values of several fields that, taken together, meet a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Fields of the grid.
    pub grid: Vec<Field>,
    /// Combinations of their values, ascending, and what is found at each; at least one.
    pub columns: Vec<Column>,
    /// Field whose best value was asked for.
    pub sought: Option<Sought>,
    /// Probability that all answers of the columns are right.
    pub confidence: f64,
}

/// Combination of the grid's values, and which values of the field that is searched meet the target there.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Value of each field of the grid; of listed values, the place.
    pub at: Vec<f64>,
    /// Answer of the search.
    pub answer: Answer,
}

/// Best value of what is sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best<'a> {
    /// The value; of listed values, the place.
    pub value: f64,
    /// Column in which it meets the target.
    pub column: &'a Column,
    /// Value of the field that is searched; of listed values, the place.
    pub searched: f64,
}

impl Region {
    /// Field that is searched at each combination.
    pub fn searched(&self) -> &Field {
        &self.columns[0].answer.field
    }

    /// Field whose best value was asked for, with its place in the grid; `None`: it is the one that is searched.
    pub(super) fn sought_field(&self, sought: &Sought) -> (&Field, Option<usize>) {
        match self.grid.iter().position(|field| field.path == sought.path) {
            Some(place) => (&self.grid[place], Some(place)),
            None => (self.searched(), None),
        }
    }

    /// Best value of what is sought that is known to meet the target; `None` where none is, or nothing is sought.
    pub fn best(&self) -> Option<Best<'_>> {
        let sought = self.sought.as_ref()?;
        let (field, place) = self.sought_field(sought);
        let number = |value: f64| field.number(value).unwrap_or(value);
        let mut best: Option<Best<'_>> = None;
        for column in &self.columns {
            for run in column.answer.on(Side::Meets) {
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

    /// Value from which on every one misses the target in every column, in the direction that is sought; `None` where some
    /// column leaves that open, or where nothing is searched for it.
    pub(super) fn missed_from(&self) -> Option<f64> {
        let sought = self.sought.as_ref()?;
        if self.searched().is_listed() || self.sought_field(sought).1.is_some() {
            return None;
        }
        let of = |column: &Column| {
            let mut misses = column.answer.on(Side::Misses);
            let span = column.answer.field.span;
            match sought.extreme {
                Extreme::Largest => misses.find(|run| run.to == span.to).map(|run| run.from),
                Extreme::Smallest => misses.find(|run| run.from == span.from).map(|run| run.to),
            }
        };
        let ends: Option<Vec<f64>> = self.columns.iter().map(of).collect();
        ends?.into_iter().reduce(match sought.extreme {
            Extreme::Largest => f64::max,
            Extreme::Smallest => f64::min,
        })
    }

    /// Column that comes nearest to the target, with the value and the sample that do: the best statistic of values of which
    /// few enough trials fail, else the fewest failures.
    pub fn nearest(&self) -> Option<(&Column, &LookedAt, &Sample)> {
        let all = self.columns.iter().filter_map(|column| {
            let (looked, sample) = column.answer.best()?;
            Some((column, looked, sample))
        });
        let answer = &self.columns[0].answer;
        let key = |sample: &Sample| -> (f64, f64) {
            let few = sample.failing() <= answer.max_failures;
            let sign = match answer.target.bound {
                Bound::AtMost => 1.0,
                Bound::AtLeast => -1.0,
            };
            match sample.statistic {
                Some((value, _)) if few => (0.0, sign * value),
                _ => (1.0, sample.failing()),
            }
        };
        all.min_by(|one, other| {
            let (one, other) = (key(one.2), key(other.2));
            one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1))
        })
    }
}
