//! Which values of one or several fields of a study meet a target, found by Monte Carlo.
//!
//! One field is searched. The others take the values of a grid, and at each combination of these the search is repeated.
//! Around the best value the grid is refined.
//!
//! Each tried value is a study of its own: the config with that value. Trials with the same number draw the same random
//! numbers at every value, so that values compare trial by trial. All cells of the study must meet the target. Failed trials
//! count as misses, because the remaining trials alone would look too good.
//!
//! Each search may be wrong with the same part of the allowed probability, so that the whole region is right with the
//! confidence of the question.

mod curves;
mod feasible_region;
mod field;
mod grid;
mod question;
mod region_figure;
mod region_table;
mod region_text;
mod target_score;

use std::cell::Cell;
use std::time::Duration;

use palpate_scene::quantities_of;
use palpate_study::Target;
use palpate_study::config::Study;
use palpate_sweep::{Clock, Curves, Run, Runner, ScoreRequest, Search, SearchResult, Side, search};

use curves::CellCurves;
use feasible_region::nearest;
use field::single_values;
use grid::{Grid, REFINEMENTS};

pub use feasible_region::{Best, DesignPoint, Region, RegionColumn, Sample};
pub use field::Field;
pub use question::{DesignError, Extreme, Question, Sought, Survey};
pub(crate) use region_text::settings_in_words;

/// Number of trials of the best value if no value meets the target.
const BEST_VALUE_TRIALS: u64 = 4096;

/// Finds which values of one or several fields meet a target, and the best value of one of them.
///
/// `progress` receives the number of tried values and of trials so far. Without a budget the result depends on the study and
/// the survey alone. The combinations of the grid share a budget.
///
/// ```
/// use std::time::Instant;
/// use palpate::{Extreme, RunOptions, Runner, Side, Sought, Survey};
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
/// let runner = Runner::new(&RunOptions::default())?;
/// let start = Instant::now();
/// let noise = "scene.noise.angular_velocity.fraction=0.001..0.1";
/// let target = "relative_rms_error(mean_curvature) <= 2 %".parse()?;
/// let survey = Survey::new(target, vec![noise.parse()?], None)?;
/// let region = palpate::design(&study, &survey, &runner, &|| start.elapsed(), &|_, _| ())?;
/// let [meets, misses] = region.columns[0].runs[..] else { panic!("{}", region.sentence()) };
/// assert!(meets.side == Side::Meets && meets.to < misses.from && misses.from < 1.06 * meets.to);
///
/// // Two objects, and the largest noise that still meets the target.
/// let fields = vec!["scene.object.radius=20,60".parse()?, noise.parse()?];
/// let path = "scene.noise.angular_velocity.fraction".to_owned();
/// let mut survey = Survey::new(target, fields, Some(Sought { path, extreme: Extreme::Largest }))?;
/// survey.question.gap = 0.2;
/// let region = palpate::design(&study, &survey, &runner, &|| start.elapsed(), &|_, _| ())?;
/// assert_eq!(region.columns.len(), 2);
/// // The sharper ball allows more noise.
/// let best = region.best().ok_or("some noise is small enough")?;
/// assert_eq!(best.column.at, [0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DesignError`].
pub fn design(
    study: &Study,
    survey: &Survey,
    runner: &Runner,
    clock: &Clock<'_>,
    progress: &dyn Fn(usize, u64),
) -> Result<Region, DesignError> {
    survey.check()?;
    let grid = Grid::new(study, survey)?;
    let max_columns = grid.max_columns(survey);
    let confidence = survey.question.confidence;
    let searches = Searches {
        study,
        grid: &grid,
        question: Question {
            confidence: 1.0 - (1.0 - confidence) / max_columns as f64,
            ..survey.question.clone()
        },
        runner,
        clock,
        progress,
        done: Cell::new((0, 0)),
    };
    let mut region = empty_region(study, survey, &grid)?;
    for (done, place) in grid.places.iter().enumerate() {
        let column = searches.search_at(place, max_columns - done)?;
        region.columns.push(column);
    }
    let rounds = if grid.is_refined(survey) {
        REFINEMENTS
    } else {
        0
    };
    for _ in 0..rounds {
        let best = region
            .best()
            .map(|best| (best.column.at.clone(), best.value));
        let Some((best, value)) = best else {
            break;
        };
        let is_end = |sought: &Sought| value == sought.extreme.end_of(grid.searched.span);
        if survey.sought.as_ref().is_some_and(is_end) {
            break;
        }
        let known = region.columns.iter().map(|column| column.at.clone());
        for place in grid.neighbours(&best, &known.collect::<Vec<_>>()) {
            let left = max_columns.saturating_sub(region.columns.len()).max(1);
            let column = searches.search_at(&place, left)?;
            region.columns.push(column);
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

/// Region of a survey before the first search.
fn empty_region(study: &Study, survey: &Survey, grid: &Grid) -> Result<Region, DesignError> {
    let question = &survey.question;
    let mut fields = single_values(&question.set);
    let varied = grid.fields.iter().chain([&grid.searched]);
    fields
        .extend(varied.map(|field| (field.path.clone(), vec![field.config_value(field.first())])));
    let study = study.varied(&fields)?;
    // The set and varied fields are the last axes, and have one value each.
    let axes = study.columns.len() - fields.len();
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
    Ok(Region {
        grid: grid.fields.clone(),
        searched: grid.searched.clone(),
        target,
        unit,
        max_failures: question.max_failures,
        confidence: question.confidence,
        cells: cells.collect::<Result<_, DesignError>>()?,
        cell_columns: study.columns.into_iter().take(axes).collect(),
        sought: survey.sought.clone(),
        columns: Vec::new(),
    })
}

/// Searches at the combinations of a grid, one after the other.
struct Searches<'a> {
    study: &'a Study,
    grid: &'a Grid,
    question: Question,
    runner: &'a Runner,
    clock: &'a Clock<'a>,
    progress: &'a dyn Fn(usize, u64),
    /// Number of values and of trials so far.
    done: Cell<(usize, u64)>,
}

impl Searches<'_> {
    /// Searches at a combination. Each of the `left` remaining searches gets the same share of the remaining time.
    fn search_at(&self, place: &[f64], left: usize) -> Result<RegionColumn, DesignError> {
        let mut question = self.question.clone();
        let fields = self.grid.fields.iter().zip(place);
        let set = fields.map(|(field, value)| (field.path.clone(), field.config_value(*value)));
        question.set.extend(set);
        let start = (self.clock)();
        let share = |budget: Duration| {
            budget.saturating_sub(start) / u32::try_from(left.max(1)).unwrap_or(u32::MAX)
        };
        question.budget = question.budget.map(share);
        let clock = || (self.clock)().saturating_sub(start);
        let before = self.done.get();
        let progress = |values: usize, trials: u64| {
            let done = (before.0 + values, before.1 + trials);
            self.done.set(done);
            (self.progress)(done.0, done.1);
        };
        let field = &self.grid.searched;
        let mut curves = CellCurves::new(self.study, &question, field, self.runner, &progress)?;
        let settings = Search {
            among: field.among(),
            gap: question.gap,
            most_trials: question.most_trials,
            budget: question.budget,
            wrong: 1.0 - question.confidence,
        };
        let found = search(&mut curves, &settings, &clock)?;
        let column = column_of(&curves, place, &found);
        if column.on(Side::Meets).next().is_some() {
            return Ok(column);
        }
        // If no value meets the target, the answer states how near the best one comes, so that one gets more trials.
        let Question {
            target,
            max_failures,
            ..
        } = question;
        let best = nearest([&column], target.bound, max_failures);
        let Some((_, point, sample)) = best else {
            return Ok(column);
        };
        curves.scores(&[ScoreRequest {
            value: point.value,
            cell: sample.cell,
            trials: trials_in_time(&column, question.budget, &clock).max(sample.trials),
            fresh: false,
        }])?;
        Ok(column_of(&curves, place, &found))
    }
}

/// Number of trials of the best value for which the remaining time is enough.
fn trials_in_time(column: &RegionColumn, budget: Option<Duration>, clock: &Clock<'_>) -> u64 {
    let Some(budget) = budget else {
        return BEST_VALUE_TRIALS;
    };
    let elapsed = clock();
    let trials: u64 = column.samples().map(|sample| sample.trials).sum();
    let each = elapsed.as_secs_f64() / trials.max(1) as f64;
    let left = budget.saturating_sub(elapsed).as_secs_f64();
    match each > 0.0 {
        true => ((left / each) as u64).min(BEST_VALUE_TRIALS),
        false => BEST_VALUE_TRIALS,
    }
}

/// Column of a search, with the trials that were run for it.
fn column_of(curves: &CellCurves<'_>, place: &[f64], found: &SearchResult) -> RegionColumn {
    let points = found.tested.iter().map(|point| DesignPoint {
        value: point.value,
        side: side_of(&found.runs, point.value),
        worst: point.worst,
        searched: curves.samples_at(point.value, false),
        fresh: curves.samples_at(point.value, true),
    });
    RegionColumn {
        at: place.to_owned(),
        points: points.collect(),
        runs: found.runs.clone(),
        narrowed: found.narrowed,
        ended: found.ended,
    }
}

/// Side of the run that contains a value.
fn side_of(runs: &[Run], value: f64) -> Option<Side> {
    let run = runs.iter().find(|run| (run.from..=run.to).contains(&value));
    run.map(|run| run.side)
}
