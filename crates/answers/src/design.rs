//! Finds, by Monte Carlo simulation, which values of one or several fields of a study meet a target.
//!
//! One field is searched. The other varied fields form a grid, and the search is repeated at each combination of the
//! grid's values. If the best value of the searched field is requested, the grid is refined: combinations near the best
//! one are added and searched too.
//!
//! At each tested value, the same trials are run as in a study with this value in its config. Trials with the same
//! number draw the same random numbers at every value, so that values can be compared trial by trial. If the study
//! itself sweeps fields, each combination of the swept values (a cell of the study) must meet the target. A value at
//! which too many trials fail misses the target, because the statistics of the successful trials alone would be too
//! good.
//!
//! The question states the probability (confidence) with which the whole answer must be right. Therefore, the allowed
//! probability of an error is divided evenly among the searches.

use std::cell::Cell;

use palpate_report::Stretch;
use palpate_study::config::Study;
use palpate_sweep::{Clock, Runner};

use crate::cell_trials::CellTrials;
use crate::error::AnswerError;
use crate::grid::{combinations, neighbours};
use crate::question::Question;
use crate::region::{DesignPoint, Region, RegionColumn};
use crate::search::{Curves, ScoreRequest, Search, Side, search};

/// Number of trials at the best tested value if no value meets the target. This number is large, so that the answer can
/// state accurately how far the best value misses the target.
const BEST_VALUE_TRIALS: u64 = 4096;
/// Largest number of refinements of the grid. Each refinement adds combinations of field values around the best
/// combination.
const REFINEMENTS: usize = 3;

/// Finds the values of one or several fields that meet a target. If the question requests an optimum, also finds the
/// best value of one of these fields.
///
/// `progress` receives the number of tested values and the number of trials so far. Without a time budget, the result
/// depends only on the study and the question. If several fields are varied, all searches together must keep within the
/// time budget.
///
/// ```
/// use std::time::Instant;
/// use palpate_answers::{Answer, Extreme, Question, Sought, design};
/// use palpate_study::config::parse;
/// use palpate_sweep::{RunOptions, Runner};
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
/// let study = parse("a-ball.toml", text)?;
/// let runner = Runner::new(&RunOptions::default())?;
/// let start = Instant::now();
/// let noise = "scene.noise.angular_velocity.fraction=0.001..0.1";
/// let target = "relative_rms_error(mean_curvature) <= 2 %".parse()?;
/// let question = Question::new(target, vec![noise.parse()?], None)?;
/// let region = design(&study, &question, &runner, &|| start.elapsed(), &|_, _| ())?;
/// let [meets, misses] = region.columns[0].runs[..] else { panic!("{}", region.lines()[0]) };
/// assert!(meets.meets && meets.to < misses.from && misses.from < 1.06 * meets.to);
///
/// // Two objects, and the largest noise that still meets the target.
/// let fields = vec!["scene.object.radius=20,60".parse()?, noise.parse()?];
/// let path = "scene.noise.angular_velocity.fraction".to_owned();
/// let mut question = Question::new(target, fields, Some(Sought { path, extreme: Extreme::Largest }))?;
/// question.gap = 0.2;
/// let region = design(&study, &question, &runner, &|| start.elapsed(), &|_, _| ())?;
/// assert_eq!(region.columns.len(), 2);
/// // The sharper ball allows more noise.
/// let best = region.best().ok_or("some noise is small enough")?;
/// assert_eq!(best.column.at, [0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnswerError`] if the question has no answer.
pub fn design(
    study: &Study,
    question: &Question,
    runner: &Runner,
    clock: &Clock<'_>,
    progress: &dyn Fn(usize, u64),
) -> Result<Region, AnswerError> {
    question.check()?;
    let mut region = Region::new(study, question)?;
    let places = combinations(&region.grid, question.gap)?;
    let refinements = region.searched_extreme().map_or(0, |_| REFINEMENTS);
    let ranges = region.grid.iter().filter(|field| !field.is_listed());
    let searches = Searches {
        study,
        runner,
        clock,
        progress,
        max_columns: places.len() + 2 * refinements * ranges.count(),
        done: Cell::new((0, 0)),
    };
    for place in places {
        let column = searches.column(&region, place)?;
        region.columns.push(column);
    }
    for _ in 0..refinements {
        let end = region.searched_extreme();
        let end = end.map(|extreme| extreme.end_of(region.searched.span));
        let Some(best) = region.best().filter(|best| Some(best.value) != end) else {
            break;
        };
        let known = region.columns.iter().map(|column| column.at.clone());
        let known: Vec<_> = known.collect();
        for place in neighbours(&region.grid, question.gap, &best.column.at, &known) {
            let column = searches.column(&region, place)?;
            region.columns.push(column);
        }
    }
    let by_place = |one: &RegionColumn, other: &RegionColumn| one.at.partial_cmp(&other.at);
    region
        .columns
        .sort_by(|one, other| by_place(one, other).unwrap_or(std::cmp::Ordering::Equal));
    Ok(region)
}

/// Runs the searches, one after another. Each search tests values of the searched field at one combination of the other
/// varied fields' values.
struct Searches<'a> {
    study: &'a Study,
    runner: &'a Runner,
    clock: &'a Clock<'a>,
    progress: &'a dyn Fn(usize, u64),
    /// Largest possible number of searches: one for each combination of the grid's values, including the combinations
    /// that refine the grid. The grid consists of the varied fields that are not searched.
    max_columns: usize,
    /// Number of tested values and number of trials so far, in all searches together.
    done: Cell<(usize, u64)>,
}

impl Searches<'_> {
    /// Searches the values of the searched field at one combination of the other varied fields' values. This search may
    /// use the remaining time, divided by the number of searches that are not done yet.
    fn column(&self, region: &Region, place: Vec<f64>) -> Result<RegionColumn, AnswerError> {
        let question = &region.question;
        let start = (self.clock)();
        let clock = || (self.clock)().saturating_sub(start);
        let left = self.max_columns.saturating_sub(region.columns.len());
        let left = u32::try_from(left.max(1)).unwrap_or(u32::MAX);
        let budget = question
            .budget
            .map(|budget| budget.saturating_sub(start) / left);
        let before = self.done.get();
        let progress = |values: usize, trials: u64| {
            let done = (before.0 + values, before.1 + trials);
            self.done.set(done);
            (self.progress)(done.0, done.1);
        };
        let mut trials = CellTrials::new(self.study, region, &place, self.runner, &progress);
        let settings = Search {
            among: region.searched.among(),
            gap: question.gap,
            most_trials: question.most_trials,
            budget,
            wrong: (1.0 - question.confidence) / self.max_columns as f64,
        };
        let found = search(&mut trials, &settings, &clock)?;
        let points = |trials: &CellTrials<'_>| {
            let points = found.tested.iter().map(|point| DesignPoint {
                value: point.value,
                side: side_of(&found.runs, point.value),
                worst: point.worst,
                searched: trials.samples_at(point.value, false),
                fresh: trials.samples_at(point.value, true),
            });
            points.collect()
        };
        let mut column = RegionColumn {
            at: place,
            points: points(&trials),
            runs: found.runs.clone(),
            narrowed: found.narrowed,
            ended: found.ended,
        };
        // If no value meets the target, the answer names the best value tried, with its result. Run more trials at this
        // value, so that this result is accurate.
        if column.on(Side::Meets).next().is_none()
            && let Some((_, point, sample)) = region.nearest([&column])
        {
            let elapsed = clock();
            let run: u64 = column.samples().map(|sample| sample.counts.trials).sum();
            let each = elapsed.as_secs_f64() / run.max(1) as f64;
            let in_time = budget.map_or(BEST_VALUE_TRIALS, |budget| {
                (budget.saturating_sub(elapsed).as_secs_f64() / each) as u64
            });
            trials.scores(&[ScoreRequest {
                value: point.value,
                cell: sample.cell,
                trials: in_time.min(BEST_VALUE_TRIALS).max(sample.counts.trials),
                fresh: false,
            }])?;
            column.points = points(&trials);
        }
        Ok(column)
    }
}

/// Whether the value `value` of the searched field meets or misses the target. Each range in `runs` contains only
/// values that meet the target, or only values that miss it. `None` if no range contains `value`.
fn side_of(runs: &[Stretch], value: f64) -> Option<Side> {
    let run = runs.iter().find(|run| (run.from..=run.to).contains(&value));
    run.map(Side::from)
}
