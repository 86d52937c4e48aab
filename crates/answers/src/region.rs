//! The answer of [`design`](crate::design): the values of one or several fields that together meet a target, and the
//! results of the trials.

use std::cmp::Ordering;

use palpate_scene::quantities_of;
use palpate_study::config::Study;
use palpate_study::{Bound, Target};

use crate::error::{AnswerError, MAX_CELLS};
use crate::field::Field;
use crate::question::{Extreme, Question, Sought};
use crate::search::{EndReason, Run, Side};
use crate::trial_counts::TrialCounts;

/// The values of one or several fields that together meet a target.
///
/// Whether the values between the ranges in [`RegionColumn::runs`] meet the target is undecided. No trials were run
/// between the tested values.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The question that was answered. If it did not name the quantity of its target, the first quantity of the scene
    /// was added.
    pub question: Question,
    /// Fields of the grid; empty if only one field is varied.
    pub grid: Vec<Field>,
    /// Field that is searched at each combination of the grid's values.
    pub searched: Field,
    /// Unit of the target's statistic, as in `cells.csv`.
    pub unit: &'static str,
    /// Columns of the fields that the study itself sweeps. All cells of this sweep must meet the target.
    pub cell_columns: Vec<String>,
    /// For each cell, the values of the fields in `cell_columns`, formatted as in the tables.
    pub cells: Vec<Vec<String>>,
    /// Combinations of the grid's values in ascending order, with the result at each combination. There is at least one
    /// combination.
    pub columns: Vec<RegionColumn>,
}

/// A combination of the grid's values, and the values of the searched field that meet the target at this combination.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionColumn {
    /// Value of each field of the grid; for listed values, the index.
    pub at: Vec<f64>,
    /// Tested values in ascending order. Listed values are in the order of the list.
    pub points: Vec<DesignPoint>,
    /// Ranges of neighbouring values on the same side of the target, in ascending order. For listed values, the ranges
    /// contain the indices of the values.
    pub runs: Vec<Run>,
    /// Number of range ends that fresh trials did not verify at the first attempt. The ranges are narrower at these
    /// ends.
    pub narrowed: usize,
    /// Reason why the search ended.
    pub ended: EndReason,
}

/// A tested value of the searched field.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignPoint {
    /// The value. For a listed value, its index.
    pub value: f64,
    /// Side of the target on which the value lies; `None` if it is undecided.
    pub side: Option<Side>,
    /// Index of the cell that decides at this value: it meets the target with the least certainty, or misses it with
    /// the greatest certainty.
    pub worst: usize,
    /// Results of the trials of each cell in the search, in the order of the cells.
    pub searched: Vec<Sample>,
    /// Results of the fresh trials that verify the answer, if there are any.
    pub fresh: Vec<Sample>,
}

/// Result of the trials of a cell at a tested value of the searched field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Index of the cell.
    pub cell: usize,
    /// Number of trials, and number of failed trials.
    pub counts: TrialCounts,
    /// The statistic of the target and its standard error; `None` if the statistic is undefined.
    pub statistic: Option<(f64, f64)>,
}

/// The best value of the optimised field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best<'a> {
    /// The value. For a listed value, its index.
    pub value: f64,
    /// Combination of the grid's values at which the value meets the target.
    pub column: &'a RegionColumn,
    /// Value of the searched field at which the best value of the optimised field meets the target. For a listed value,
    /// its index.
    pub searched: f64,
}

impl RegionColumn {
    /// The ranges of values on one side of the target.
    pub fn on(&self, side: Side) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(move |run| run.side == side)
    }

    /// The results of all cells at all tested values.
    pub(crate) fn samples(&self) -> impl Iterator<Item = &Sample> {
        let points = self.points.iter();
        points.flat_map(|point| point.searched.iter().chain(&point.fresh))
    }
}

impl Region {
    /// The region before the first search, without results.
    pub(crate) fn new(study: &Study, question: &Question) -> Result<Self, AnswerError> {
        let mut fixed: Vec<_> = single_values(&question.set).collect();
        let mut fields = Vec::new();
        for vary in question.grid.iter().chain([&question.searched]) {
            let field = Field::new(study, &fixed, vary)?;
            fixed.push(field.fixed_at(field.first()));
            fields.push(field);
        }
        let sought = question.sought.as_ref();
        sought.map_or(Ok(()), |sought| check_order(&fields, &sought.path))?;
        let study = study.varied(&fixed)?;
        if study.cell_count() > MAX_CELLS {
            return Err(AnswerError::TooManyCells(study.cell_count()));
        }
        // Leave out the fixed fields, which are the last axes and have one value each.
        let axes = study.columns.len() - fixed.len();
        let cells = (0..study.cell_count()).map(|cell| {
            let coordinates = study.cell(cell)?.coordinates;
            Ok(coordinates.into_iter().take(axes).collect())
        });
        let first_quantity = quantities_of(&study.config.scene).first().copied();
        let target = Target {
            quantity: question.target.quantity.or(first_quantity),
            ..question.target
        };
        let unit = match target.quantity {
            _ if target.statistic.is_number() => "1",
            Some(quantity) => quantity.unit.of(study.config.length_unit),
            None => "",
        };
        let searched = fields.pop().ok_or(AnswerError::NothingVaried)?;
        Ok(Self {
            question: Question {
                target,
                ..question.clone()
            },
            grid: fields,
            searched,
            unit,
            cells: cells.collect::<Result<_, AnswerError>>()?,
            cell_columns: study.columns.iter().take(axes).cloned().collect(),
            columns: Vec::new(),
        })
    }

    /// Fields with one value each: the set fields, and the fields of the grid at one combination.
    pub(crate) fn fixed_at(&self, place: &[f64]) -> Vec<(String, Vec<toml::Value>)> {
        let grid = self.grid.iter().zip(place);
        let grid = grid.map(|(field, value)| field.fixed_at(*value));
        single_values(&self.question.set).chain(grid).collect()
    }

    /// The field whose best value is wanted, and its index in the grid; `None` if it is the searched field.
    pub(crate) fn sought_field(&self, sought: &Sought) -> (&Field, Option<usize>) {
        match self.grid.iter().position(|field| field.path == sought.path) {
            Some(place) => (&self.grid[place], Some(place)),
            None => (&self.searched, None),
        }
    }

    /// Whether the largest or the smallest value of the searched field is wanted; `None` if another field is optimised.
    pub(crate) fn searched_extreme(&self) -> Option<Extreme> {
        let sought = self.question.sought.as_ref()?;
        (sought.path == self.searched.path).then_some(sought.extreme)
    }

    /// Best value of the optimised field that certainly meets the target; `None` if there is none, or if no field is
    /// optimised.
    pub fn best(&self) -> Option<Best<'_>> {
        let sought = self.question.sought.as_ref()?;
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

    /// Limit of the optimised field beyond which all better values miss the target at every combination of the grid.
    /// `None` if this is undecided at some combination, if the optimised field is not the searched field, or if it has
    /// listed values.
    pub(crate) fn missed_from(&self) -> Option<f64> {
        let extreme = self.searched_extreme()?;
        if self.searched.is_listed() {
            return None;
        }
        let span = self.searched.span;
        let missed_from = |column: &RegionColumn| {
            let mut misses = column.on(Side::Misses);
            match extreme {
                Extreme::Largest => misses.find(|run| run.to == span.to).map(|run| run.from),
                Extreme::Smallest => misses.find(|run| run.from == span.from).map(|run| run.to),
            }
        };
        let ends: Option<Vec<f64>> = self.columns.iter().map(missed_from).collect();
        ends?.into_iter().reduce(match extreme {
            Extreme::Largest => f64::max,
            Extreme::Smallest => f64::min,
        })
    }

    /// Whether more trials of the sample fail than the question allows.
    pub(crate) fn is_failing(&self, sample: &Sample) -> bool {
        sample.counts.failure_rate() > self.question.max_failures
    }

    /// The result of the cell that decides at a tested value. If too many trials fail in at least one cell, this is the
    /// cell with the largest share of failures. Otherwise, it is the cell with the worst statistic.
    pub(crate) fn decisive<'a>(&self, point: &'a DesignPoint) -> Option<&'a Sample> {
        let samples = point.searched.iter();
        samples.max_by(|one, other| self.by_rank(one, other))
    }

    /// The value that comes nearest to meeting the target, among the values at several combinations. It is returned
    /// with its combination and with the result of its decisive cell. Among the values with few enough failures, it is
    /// the value with the best statistic. If too many trials fail at all values, it is the value with the fewest
    /// failures.
    pub(crate) fn nearest<'a>(
        &self,
        columns: impl IntoIterator<Item = &'a RegionColumn>,
    ) -> Option<(&'a RegionColumn, &'a DesignPoint, &'a Sample)> {
        let points = columns
            .into_iter()
            .flat_map(|column| column.points.iter().map(move |point| (column, point)));
        let all = points.filter_map(|(column, point)| Some((column, point, self.decisive(point)?)));
        all.min_by(|one, other| self.by_rank(one.2, other.2))
    }

    /// Compares two results; the worse result is the greater one. Results are compared by their statistics. A result
    /// with too many failures, or without a statistic, is worse than all other results. Such results are compared by
    /// their shares of failures.
    fn by_rank(&self, one: &Sample, other: &Sample) -> Ordering {
        let rank = |sample: &Sample| match (sample.statistic, self.question.target.bound) {
            _ if self.is_failing(sample) => (1, sample.counts.failure_rate()),
            (Some((value, _)), Bound::AtMost) => (0, value),
            (Some((value, _)), Bound::AtLeast) => (0, -value),
            (None, _) => (1, sample.counts.failure_rate()),
        };
        let (one, other) = (rank(one), rank(other));
        one.0.cmp(&other.0).then(one.1.total_cmp(&other.1))
    }
}

/// The set fields, in the form of varied fields with one value each.
fn single_values(
    set: &[(String, toml::Value)],
) -> impl Iterator<Item = (String, Vec<toml::Value>)> {
    let fields = set.iter();
    fields.map(|(path, value)| (path.clone(), vec![value.clone()]))
}

/// Returns an error if the optimised field is not varied, or if its values are not numbers.
fn check_order(fields: &[Field], path: &str) -> Result<(), AnswerError> {
    let field = fields.iter().find(|field| field.path == path);
    let field = field.ok_or_else(|| AnswerError::NotVaried(path.to_owned()))?;
    let mut listed = (0..field.listed.len()).map(|place| place as f64);
    match listed.find(|place| field.number(*place).is_none()) {
        Some(place) => Err(AnswerError::NoOrder {
            path: path.to_owned(),
            text: field.text(place),
        }),
        None => Ok(()),
    }
}
