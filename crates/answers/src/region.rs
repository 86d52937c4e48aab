//! The answer of [`design`](crate::design): the values of one or several fields that together meet a target, and the
//! results of the trials that were run.

use std::cmp::Ordering;

use palpate_report::{Figure, ReportError, Stretch};
use palpate_scene::quantities_of;
use palpate_study::config::Study;
use palpate_study::{Bound, Table, Target};
use serde_json::Value;

use crate::Answer;
use crate::cell_trials::TrialCounts;
use crate::error::{AnswerError, MAX_CELLS};
use crate::field::Field;
use crate::question::{Extreme, Question, Sought};
use crate::search::{EndReason, Side};

/// The values of one or several fields that together meet a target.
///
/// [`RegionColumn::runs`] contains the ranges of values that meet the target, and the ranges of values that miss it.
/// For values between two ranges, this is undecided. The ends of the ranges are tested values; no trials were run
/// between the tested values.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The answered question. If the question did not name the quantity of its target, this copy names the first
    /// quantity of the scene.
    pub question: Question,
    /// Varied fields that are not searched (the grid); empty if only one field is varied.
    pub grid: Vec<Field>,
    /// Field that is searched at each combination of values of the fields in `grid`.
    pub searched: Field,
    /// Unit of the target's statistic, as in `cells.csv`.
    pub unit: &'static str,
    /// Columns of the fields that the study itself sweeps. All combinations of their values (the cells of the study)
    /// must meet the target.
    pub cell_columns: Vec<String>,
    /// For each cell, the values of the fields in `cell_columns`, formatted as in the tables.
    pub cells: Vec<Vec<String>>,
    /// One result for each combination of values of the fields in `grid`, in ascending order of these values. There is
    /// at least one combination.
    pub columns: Vec<RegionColumn>,
}

/// The result at one combination of values of the fields in [`Region::grid`]: the values of the searched field that
/// meet the target.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionColumn {
    /// Value of each field in [`Region::grid`]. For a field with listed values, this is the index in its list.
    pub at: Vec<f64>,
    /// Tested values of the searched field, in ascending order. Listed values are in the order of the list.
    pub(crate) points: Vec<DesignPoint>,
    /// Ranges of neighbouring values of the searched field that all meet or all miss the target, in ascending order.
    /// For listed values, the ranges contain the indices of the values.
    pub runs: Vec<Stretch>,
    /// Number of range ends that fresh trials (trials that the search had not used) did not confirm at the first
    /// attempt. The ranges were shortened at these ends.
    pub narrowed: usize,
    /// Reason why the search at this combination of values ended.
    pub(crate) ended: EndReason,
}

/// A tested value of the searched field.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DesignPoint {
    /// The tested value of the searched field. For a listed value, its index in the list.
    pub(crate) value: f64,
    /// Whether the tested value meets or misses the target; `None` if the trials have not decided this.
    pub(crate) side: Option<Side>,
    /// Index of the decisive cell of the study: the cell that meets the target least clearly, or misses it most
    /// clearly.
    pub(crate) worst: usize,
    /// Results of each cell of the study, in the order of the cells. They come from the trials that the search used.
    pub(crate) searched: Vec<Sample>,
    /// Results of each cell of the study from the fresh trials that verify the answer; empty if no fresh trials were
    /// run at this value.
    pub(crate) fresh: Vec<Sample>,
}

/// Result of a cell of the study at a tested value of the searched field, computed from the cell's trials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// Index of the cell (combination of values that the study itself sweeps).
    pub(crate) cell: usize,
    /// Number of trials of the cell of the study, and number of failed trials.
    pub(crate) counts: TrialCounts,
    /// The statistic of the target and its standard error; `None` if the statistic is undefined.
    pub(crate) statistic: Option<(f64, f64)>,
}

/// The best value of the optimised field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best<'a> {
    /// The value of the optimised field. For a listed value, its index in the list.
    pub value: f64,
    /// The result at the combination of values of the fields in [`Region::grid`] at which `value` meets the target.
    pub column: &'a RegionColumn,
    /// Value of the searched field at which the target is met together with `value`. For a listed value, its index in
    /// the list.
    pub searched: f64,
}

impl RegionColumn {
    /// The ranges of the searched field whose values all meet the target, or all miss it, as `side` states.
    pub(crate) fn on(&self, side: Side) -> impl Iterator<Item = &Stretch> {
        self.runs.iter().filter(move |run| Side::from(*run) == side)
    }

    pub(crate) fn samples(&self) -> impl Iterator<Item = &Sample> {
        let points = self.points.iter();
        points.flat_map(|point| point.searched.iter().chain(&point.fresh))
    }
}

impl Region {
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
        // Leave out the fixed fields, which are the last axes of the study and have one value each.
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

    /// Fields that have one fixed value: the fields that the question fixes, and the fields of the grid, whose values
    /// are in `place`.
    pub(crate) fn fixed_at(&self, place: &[f64]) -> Vec<(String, Vec<toml::Value>)> {
        let grid = self.grid.iter().zip(place);
        let grid = grid.map(|(field, value)| field.fixed_at(*value));
        single_values(&self.question.set).chain(grid).collect()
    }

    /// The optimised field, and its index in the grid. The index is `None` if the optimised field is the searched
    /// field.
    pub(crate) fn sought_field(&self, sought: &Sought) -> (&Field, Option<usize>) {
        match self.grid.iter().position(|field| field.path == sought.path) {
            Some(place) => (&self.grid[place], Some(place)),
            None => (&self.searched, None),
        }
    }

    /// Whether the answer states the largest or the smallest value of the searched field that meets the target; `None`
    /// if the searched field is not optimised.
    pub(crate) fn searched_extreme(&self) -> Option<Extreme> {
        let sought = self.question.sought.as_ref()?;
        (sought.path == self.searched.path).then_some(sought.extreme)
    }

    /// Best value of the optimised field that certainly meets the target; `None` if no value does, or if no field is
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

    /// Value of the searched field beyond which all values miss the target, at every combination of the other varied
    /// fields' values. `None` if the limit is undecided at some combination, if the searched field is not the optimised
    /// field, or if the values of the searched field are listed.
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

    pub(crate) fn is_failing(&self, sample: &Sample) -> bool {
        sample.counts.failure_rate() > self.question.max_failures
    }

    /// The decisive cell's result at a tested value. If too many trials fail in any cell of the study, the decisive
    /// cell is the cell with the largest share of failures. Otherwise, it is the cell with the worst statistic.
    pub(crate) fn decisive<'a>(&self, point: &'a DesignPoint) -> Option<&'a Sample> {
        let samples = point.searched.iter();
        samples.max_by(|one, other| self.by_rank(one, other))
    }

    /// Finds the tested value in `columns` (combinations of the grid's values) that comes nearest to meeting the
    /// target. It is the value with the best statistic; if too many trials fail at every value, it is the value with
    /// the smallest share of failures. Returns the column to which the value belongs, the value, and the result of the
    /// cell that decides whether the value meets the target.
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

    /// Compares the results of two cells of the study; the worse result is the greater one. Results with too many
    /// failures or without a statistic are worse than all other results. Two such results are compared by their shares
    /// of failed trials. All other results are compared by their statistics.
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

fn single_values(
    set: &[(String, toml::Value)],
) -> impl Iterator<Item = (String, Vec<toml::Value>)> {
    let fields = set.iter();
    fields.map(|(path, value)| (path.clone(), vec![value.clone()]))
}

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

impl Answer for Region {
    fn lines(&self) -> Vec<String> {
        let sentence = std::iter::once(self.sentence());
        sentence.chain(self.details()).collect()
    }

    fn table(&self) -> Table {
        self.results_table()
    }

    fn to_json(&self, study: &Study) -> Value {
        self.region_json(study)
    }

    fn figure(&self, name: &str, title: &str) -> Result<Figure, ReportError> {
        self.region_figure(name, title)
    }
}
