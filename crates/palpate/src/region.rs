//! Feasible region of several fields, and the best value of one of them, by Monte Carlo.
//!
//! All fields but one take the values of a grid; at each of its combinations the last is searched as [`design`] does. Every
//! search may be wrong with an equal share of the probability, so that all of the region is right with the confidence that
//! is asked for. About the best value the grid is made finer.

mod figure;
mod found;
mod grid;
mod json;
mod survey;
mod table;
mod words;

use std::cell::Cell;
use std::time::Duration;

use palpate_study::config::Study;
use palpate_sweep::{Clock, Runner};

use crate::design::{Answer, DesignError, Question, design};
use grid::Grid;

pub use found::{Best, Column as RegionColumn, Region};
pub use survey::{Extreme, Sought, Survey};

/// Finds which values of several fields, taken together, meet a target, and the best value of one of them.
///
/// `progress` is told, whenever some have been run, at how many values there are how many trials. Without a budget the
/// result hangs on the study and the survey alone; a budget is shared by the combinations.
///
/// ```
/// use std::time::Instant;
/// use palpate::{Extreme, RunOptions, Runner, Sought, Survey};
///
/// let text = r#"
/// name = "a-ball"
/// length_unit = "mm"
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.5, duration_s = 1.0 }
/// noise = { angular_velocity = { kind = "uniform", fraction = 0.01 } }
/// "#;
/// let study = palpate::parse("a-ball.toml", text)?;
/// let target = "relative_rms_error(mean_curvature) <= 2 %".parse()?;
/// let fields = vec![
///     "scene.object.radius=20,60".parse()?,
///     "scene.noise.angular_velocity.fraction=0.001..0.1".parse()?,
/// ];
/// let path = "scene.noise.angular_velocity.fraction".to_owned();
/// let sought = Sought { path, extreme: Extreme::Largest };
/// let mut survey = Survey::new(target, fields, Some(sought))?;
/// survey.question.gap = 0.2;
/// let runner = Runner::new(&RunOptions::default())?;
/// let start = Instant::now();
/// let region = palpate::region(&study, &survey, &runner, &|| start.elapsed(), &|_, _| ())?;
/// assert_eq!(region.columns.len(), 2);
/// // The sharper ball is told with more noise.
/// let best = region.best().ok_or("some noise is little enough")?;
/// assert_eq!(best.column.at, [0.0]);
/// // Each column is surer than both together are.
/// assert!(region.confidence == 0.95 && best.column.answer.confidence == 0.975);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DesignError`].
pub fn region(
    study: &Study,
    survey: &Survey,
    runner: &Runner,
    clock: &Clock<'_>,
    progress: &dyn Fn(usize, u64),
) -> Result<Region, DesignError> {
    let grid = Grid::of(study, survey)?;
    let most = grid.most(survey);
    let confidence = survey.question.confidence;
    let question = Question {
        confidence: 1.0 - (1.0 - confidence) / most as f64,
        ..survey.question.clone()
    };
    let search = Columns {
        study,
        grid: &grid,
        question,
        runner,
        clock,
        progress,
        told: Cell::new((0, 0)),
    };
    let mut region = Region {
        grid: grid.fields.clone(),
        columns: Vec::new(),
        sought: survey.sought.clone(),
        confidence,
    };
    for (done, place) in grid.places.iter().enumerate() {
        let answer = search.at(place, most - done)?;
        region.columns.push(RegionColumn {
            at: place.clone(),
            answer,
        });
    }
    if grid.is_refined(survey) {
        for _ in 0..grid.rounds() {
            let Some((best, value)) = region
                .best()
                .map(|best| (best.column.at.clone(), best.value))
            else {
                break;
            };
            let is_end = |sought: &Sought| value == grid.end(sought.extreme);
            if survey.sought.as_ref().is_some_and(is_end) {
                break;
            }
            let known: Vec<Vec<f64>> = region
                .columns
                .iter()
                .map(|column| column.at.clone())
                .collect();
            for place in grid.closer(&best, &known) {
                let left = most.saturating_sub(region.columns.len()).max(1);
                let answer = search.at(&place, left)?;
                region.columns.push(RegionColumn { at: place, answer });
            }
        }
    }
    let by_place = |one: &RegionColumn, other: &RegionColumn| {
        let mut pairs = one.at.iter().zip(&other.at);
        let differ = pairs.find(|(one, other)| one != other);
        differ.map_or(std::cmp::Ordering::Equal, |(one, other)| {
            one.total_cmp(other)
        })
    };
    region.columns.sort_by(by_place);
    Ok(region)
}

/// Searches at the combinations of a grid, one after the other.
struct Columns<'a> {
    study: &'a Study,
    grid: &'a Grid,
    question: Question,
    runner: &'a Runner,
    clock: &'a Clock<'a>,
    progress: &'a dyn Fn(usize, u64),
    /// Values and trials so far.
    told: Cell<(usize, u64)>,
}

impl Columns<'_> {
    /// Answer at a combination, in its share of the time where `left` are still to be searched.
    fn at(&self, place: &[f64], left: usize) -> Result<Answer, DesignError> {
        let mut question = self.question.clone();
        let fields = self.grid.fields.iter().zip(place);
        let set = fields.map(|(field, value)| (field.path.clone(), field.written(*value)));
        question.set.extend(set);
        let start = (self.clock)();
        let share = |budget: Duration| {
            budget.saturating_sub(start) / u32::try_from(left.max(1)).unwrap_or(u32::MAX)
        };
        question.budget = question.budget.map(share);
        let before = self.told.get();
        let progress = |values: usize, trials: u64| {
            let told = (before.0 + values, before.1 + trials);
            self.told.set(told);
            (self.progress)(told.0, told.1);
        };
        design(
            self.study,
            &question,
            self.runner,
            &|| (self.clock)().saturating_sub(start),
            &progress,
        )
    }
}
