//! Answer of a design: the values of one or several fields that, taken together, meet a target, and the trials behind it.

use std::cmp::Ordering;

use palpate_scene::quantities_of;
use palpate_study::config::Study;
use palpate_study::{Bound, Target};

use crate::error::{AnswerError, MAX_CELLS};
use crate::field::Field;
use crate::question::{Extreme, Question, Sought};
use crate::search::{EndReason, Run, Side};
use crate::trial_counts::TrialCounts;

/// Values of one or several fields that, taken together, meet a target.
///
/// Values between [`RegionColumn::runs`] are undecided. Between tried values nothing was observed.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The question; its target has a quantity.
    pub question: Question,
    /// Fields of the grid; none if a single field is varied.
    pub grid: Vec<Field>,
    /// Field that is searched at each combination of the grid's values.
    pub searched: Field,
    /// Unit of the target's statistic, as in `cells.csv`.
    pub unit: &'static str,
    /// Columns of the other swept fields. All their cells must meet the target together.
    pub cell_columns: Vec<String>,
    /// Values of these fields in each cell, as the tables show them.
    pub cells: Vec<Vec<String>>,
    /// Combinations of the grid's values in ascending order, with the result at each; at least one.
    pub columns: Vec<RegionColumn>,
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
    /// Numbers of trials.
    pub counts: TrialCounts,
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

impl RegionColumn {
    /// Runs of values that meet the target, or miss it.
    pub fn on(&self, side: Side) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(move |run| run.side == side)
    }

    /// All samples of all values.
    pub(crate) fn samples(&self) -> impl Iterator<Item = &Sample> {
        let points = self.points.iter();
        points.flat_map(|point| point.searched.iter().chain(&point.fresh))
    }
}

impl Region {
    /// Region before the first search.
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
        // The fixed fields are the last axes, and have one value each.
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

    /// Values of the set fields, and of the grid's fields at one grid point.
    pub(crate) fn fixed_at(&self, place: &[f64]) -> Vec<(String, Vec<toml::Value>)> {
        let grid = self.grid.iter().zip(place);
        let grid = grid.map(|(field, value)| field.fixed_at(*value));
        single_values(&self.question.set).chain(grid).collect()
    }

    /// Field whose best value was wanted, with its place in the grid; `None`: it is the searched one.
    pub(crate) fn sought_field(&self, sought: &Sought) -> (&Field, Option<usize>) {
        match self.grid.iter().position(|field| field.path == sought.path) {
            Some(place) => (&self.grid[place], Some(place)),
            None => (&self.searched, None),
        }
    }

    /// Which value of the searched field was wanted, if it is the sought one.
    pub(crate) fn searched_extreme(&self) -> Option<Extreme> {
        let sought = self.question.sought.as_ref()?;
        (sought.path == self.searched.path).then_some(sought.extreme)
    }

    /// Best value of the sought field that certainly meets the target; `None` if there is none, or no field is sought.
    pub(crate) fn best(&self) -> Option<Best<'_>> {
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

    /// Value from which on every value misses the target in every column, in the sought direction; `None` if this is open
    /// in some column, or if the sought field is not a searched range.
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

    /// Whether more trials of a sample fail than the question allows.
    pub(crate) fn is_failing(&self, sample: &Sample) -> bool {
        sample.counts.failure_rate() > self.question.max_failures
    }

    /// The sample that decides at a tried value: if too many trials fail in some cell, the one with the largest share of
    /// failures, else the one whose statistic is furthest on the wrong side.
    pub(crate) fn decisive<'a>(&self, point: &'a DesignPoint) -> Option<&'a Sample> {
        let samples = point.searched.iter();
        samples.max_by(|one, other| self.by_rank(one, other))
    }

    /// Value that comes nearest to the target in some columns, with its column and its decisive sample: the best statistic
    /// of the values with few enough failures, else the fewest failures.
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

    /// Orders samples, the worse one last: by their statistics, and above all of these by their shares of failures if these
    /// are too large or leave no statistic.
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

/// Set fields as varied fields with one value each.
fn single_values(
    set: &[(String, toml::Value)],
) -> impl Iterator<Item = (String, Vec<toml::Value>)> {
    let fields = set.iter();
    fields.map(|(path, value)| (path.clone(), vec![value.clone()]))
}

/// Rejects a sought field that is not varied, or whose values are not numbers.
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
