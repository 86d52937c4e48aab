//! Answers to the question which values of a field meet a target, by Monte Carlo.
//!
//! Each value that is looked at is a study of its own: the config with that value. Trials of one number draw the same random
//! numbers at every value, so that values compare trial by trial. The target is to hold in every cell of the study at once;
//! failed trials belong to it, for the survivors flatter.

mod answer;
mod curves;
mod field;
mod figure;
mod json;
mod measure;
mod question;
mod table;
mod words;

use std::collections::BTreeMap;

use palpate_scene::quantities_of;
use palpate_study::Target;
use palpate_study::config::Study;
use palpate_sweep::{Clock, Curves, Run, Runner, ScoreRequest, Search, SearchResult, Side, search};

use curves::CellCurves;

pub use answer::{Answer, LookedAt, Sample};
pub use field::Field;
pub(crate) use json::{found, shown};
pub(crate) use question::MOST_COLUMNS;
pub use question::{DesignError, Question};
pub(crate) use table::verdict;
pub(crate) use words::{first_letter_large, joined, notes, sure, trials_in_words};

/// Trials by which the best value is known where none meets the target.
const BEST: u64 = 4096;

/// Finds the values of a field at which all cells of a study meet a target.
///
/// `progress` is told, whenever some have been run, at how many values there are how many trials. Without a budget the
/// result hangs on the study and the question alone.
///
/// ```
/// use std::time::Instant;
/// use palpate::{Question, RunOptions, Runner, Side};
///
/// let text = r#"
/// name = "a-ball"
/// length_unit = "mm"
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.5, duration_s = 1.0 }
/// sensor = { kind = "pads", pitch = 0.5, layout = "uniform", offset = "random" }
/// "#;
/// let study = palpate::parse("a-ball.toml", text)?;
/// let target = "relative_rms_error(mean_curvature) <= 5 %".parse()?;
/// let question = Question::new(target, "scene.sensor.pitch=0.05..1".parse()?);
/// let runner = Runner::new(&RunOptions::default())?;
/// let start = Instant::now();
/// let answer = palpate::design(&study, &question, &runner, &|| start.elapsed(), &|_, _| ())?;
/// let [meets, misses] = answer.runs[..] else { panic!("{}", answer.sentence()) };
/// assert!(meets.side == Side::Meets && meets.to < misses.from && misses.from < 1.06 * meets.to);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DesignError`].
pub fn design(
    study: &Study,
    question: &Question,
    runner: &Runner,
    clock: &Clock<'_>,
    progress: &dyn Fn(usize, u64),
) -> Result<Answer, DesignError> {
    check(question)?;
    let field = Field::of(study, &question.set, &question.vary)?;
    let mut curves = CellCurves::new(study, question, &field, runner, progress)?;
    let asked = Search {
        among: field.among(),
        gap: question.gap,
        most_trials: question.most_trials,
        budget: question.budget,
        wrong: 1.0 - question.confidence,
    };
    let found = search(&mut curves, &asked, clock)?;
    let answer = assembled(&curves, question, &found)?;
    if answer.on(Side::Meets).next().is_some() {
        return Ok(answer);
    }
    // What is best is worth knowing well where nothing is good enough.
    if let Some((looked, sample)) = answer.best() {
        let known = known_in_time(&answer, question, clock);
        curves.scores(&[ScoreRequest {
            value: looked.value,
            cell: sample.cell,
            trials: known.max(sample.trials),
            fresh: false,
        }])?;
    }
    assembled(&curves, question, &found)
}

/// Trials by which the best value is known, as far as there is time.
fn known_in_time(answer: &Answer, question: &Question, clock: &Clock<'_>) -> u64 {
    let Some(budget) = question.budget else {
        return BEST;
    };
    let elapsed = clock();
    let trials: u64 = answer.samples().map(|sample| sample.trials).sum();
    let each = elapsed.as_secs_f64() / trials.max(1) as f64;
    let left = budget.saturating_sub(elapsed).as_secs_f64();
    if each > 0.0 {
        ((left / each) as u64).min(BEST)
    } else {
        BEST
    }
}

/// The answer of what was found and run.
fn assembled(
    curves: &CellCurves<'_>,
    question: &Question,
    found: &SearchResult,
) -> Result<Answer, DesignError> {
    let field = curves.field().clone();
    let mut samples: BTreeMap<(u64, bool), Vec<Sample>> = BTreeMap::new();
    for (((value, cell), fresh), sampled) in &curves.samples {
        samples.entry((*value, *fresh)).or_default().push(Sample {
            cell: *cell,
            trials: sampled.trials,
            failed: sampled.failed,
            statistic: sampled.statistic,
        });
    }
    let mut looked = Vec::new();
    for one in &found.tested {
        let mut of = |fresh: bool| {
            let known = samples.remove(&(one.value.to_bits(), fresh));
            known.unwrap_or_default()
        };
        looked.push(LookedAt {
            value: one.value,
            side: side_of(&found.runs, one.value),
            worst: one.worst,
            searched: of(false),
            fresh: of(true),
        });
    }
    let told = curves.study_at(found.tested.first().map_or(0.0, |looked| looked.value))?;
    // The field itself and what is set are the last, and the same in all cells.
    let axes = told.columns.len() - 1 - question.set.len();
    let cells = (0..told.cell_count()).map(|cell| {
        let coordinates = told.cell(cell)?.coordinates;
        Ok(coordinates.into_iter().take(axes).collect())
    });
    let cells: Result<_, DesignError> = cells.collect();
    let quantities = quantities_of(&told.config.scene);
    let target = Target {
        quantity: question.target.quantity.or(quantities.first().copied()),
        ..question.target
    };
    Ok(Answer {
        unit: unit(&told, &target),
        target,
        max_failures: question.max_failures,
        confidence: question.confidence,
        columns: told.columns.iter().take(axes).cloned().collect(),
        cells: cells?,
        looked,
        runs: found.runs.clone(),
        narrowed: found.narrowed,
        ended: found.ended,
        field,
    })
}

/// Side of the run in which a value lies.
fn side_of(runs: &[Run], value: f64) -> Option<Side> {
    let run = runs.iter().find(|run| (run.from..=run.to).contains(&value));
    run.map(|run| run.side)
}

/// Unit of a target's statistic.
fn unit(study: &Study, target: &Target) -> &'static str {
    match target.statistic {
        statistic if statistic.is_number() => "1",
        _ => target
            .quantity
            .map_or("", |quantity| quantity.unit.of(study.config.length_unit)),
    }
}

/// Refuses settings that are out of their ranges.
fn check(question: &Question) -> Result<(), DesignError> {
    let Question {
        target,
        max_failures,
        vary,
        set,
        gap,
        most_trials,
        confidence,
        ..
    } = question;
    let refused = |setting, value, expected| {
        Err(DesignError::OutOfRange {
            setting,
            value,
            expected,
        })
    };
    if !(*max_failures > 0.0 && *max_failures <= 1.0) {
        let expected = "above 0, for no number of trials shows that none fails, and at most 1";
        return refused("max_failures", *max_failures, expected);
    }
    if !(*gap > 0.0 && *gap <= 1.0) {
        return refused("gap", *gap, "above 0 and at most 1");
    }
    if *most_trials == 0 {
        return refused("most_trials", 0.0, "at least 1");
    }
    if !(*confidence > 0.0 && *confidence < 1.0) {
        return refused("confidence", *confidence, "above 0 and below 1");
    }
    if !target.limit.is_finite() || target.statistic.is_size() && target.limit <= 0.0 {
        let expected = match target.statistic.is_size() {
            true => "finite and above 0",
            false => "finite",
        };
        return refused("limit", target.limit, expected);
    }
    let mut paths: Vec<&str> = set.iter().map(|(path, _)| path.as_str()).collect();
    paths.push(&vary.path);
    paths.sort_unstable();
    match paths.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(DesignError::Twice(pair[0].to_owned())),
        None => Ok(()),
    }
}
