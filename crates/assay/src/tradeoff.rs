//! Measures the error (relative to a reference) and the cost per evaluation for the entries of every ladder. A ladder
//! is a list of models, sensors or settings for the same task; its entries are called rungs.
//!
//! | ladder | reference |
//! |---|---|
//! | rolling | closed-form solutions on a ball and a paraboloid; on the ellipsoid, integrators of other equations (in charts) |
//! | gliding | the offset surface of a ball, a saddle, an ellipsoid |
//! | pads, probes, fits | the object's curvature, in closed form |
//! | press models | quadrature over wavenumbers: [`crate::paraboloid_reference`] |
//! | press sensors, press estimators | the true effective radius |

mod ep1_trials;
mod ep2_trials;
mod gliding_models;
mod ladder;
mod ladder_tables;
mod press_models;
mod press_trials;
mod rolling_models;
mod scene_trials;

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};

use crate::timing::{self, Evaluation};
use ladder::Ladder;
use ladder_tables::{MeasuredRung, MeasuredScene};

/// Options for measuring all ladders (lists of compared models or settings).
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Folder to which the tables are written.
    pub out: &'a Path,
    /// Description of the machine, for the tables.
    pub machine: &'a str,
    /// Whether the time of each model or setting is measured only briefly.
    pub quick: bool,
    /// Whether the program only runs the computations whose instructions valgrind counts; see [`timing::instructions`].
    pub counted: bool,
}

fn ladders() -> Result<Vec<Ladder>> {
    Ok(vec![
        rolling_models::ladder()?,
        gliding_models::ladder(),
        ep1_trials::pads(),
        ep1_trials::probes(),
        ep2_trials::fits(),
        press_models::ladder(),
        press_trials::sensors(),
        press_trials::estimators(),
    ])
}

/// Measures all models and settings of every ladder (list of compared entries). Writes `ladders.csv`, `rungs.csv` and
/// `answers.csv`. `report` is called with the name of each step.
///
/// # Errors An error if a model or setting fails on its scene, the instructions cannot be counted, or a table cannot be
/// written.
pub fn run(options: Options<'_>, report: impl Fn(&str)) -> Result<()> {
    let ladders = ladders()?;
    if options.counted {
        let scenes = ladders.into_iter().flat_map(|ladder| ladder.scenes);
        let rungs = scenes.flat_map(|scene| scene.rungs);
        timing::count(rungs.map(|rung| rung.evaluation));
        return Ok(());
    }
    std::fs::create_dir_all(options.out)
        .with_context(|| format!("cannot make {}", options.out.display()))?;
    report("counting instructions");
    let scenes = ladders.iter().flat_map(|ladder| &ladder.scenes);
    let scales = scenes.flat_map(|scene| scene.rungs.iter().map(|rung| rung.evaluation.scale()));
    let counts = timing::instructions(&scales.collect::<Vec<u32>>())?;
    if counts.is_none() {
        report(timing::NO_VALGRIND);
    }
    let patience = Duration::from_millis(if options.quick { 10 } else { 250 });
    let mut rung_counts = counts.into_iter().flatten();
    let mut all = Vec::new();
    for ladder in ladders {
        report(ladder.name);
        for scene in ladder.scenes {
            let rungs = measure(scene.rungs, &mut rung_counts, patience)
                .with_context(|| format!("{} on {}", ladder.name, scene.scene))?;
            all.push(MeasuredScene {
                ladder: ladder.name,
                title: ladder.title,
                error: ladder.error,
                evaluation: ladder.evaluation,
                ease: scene.ease,
                scene: scene.scene,
                rungs,
            });
        }
    }
    ladder_tables::write(&all, options.machine, options.out)
}

fn measure(
    rungs: Vec<ladder::Rung>,
    instructions: &mut impl Iterator<Item = u64>,
    patience: Duration,
) -> Result<Vec<MeasuredRung>> {
    let measure = |rung: ladder::Rung| {
        // Compute the error before measuring the time, because this computation fails if the model cannot compute the
        // scene.
        let error = (rung.error)().with_context(|| rung.name.clone())?;
        let mut evaluation: Evaluation = rung.evaluation;
        let ns = evaluation.time(patience);
        Ok(MeasuredRung {
            name: rung.name,
            setting: rung.setting,
            error,
            ns,
            instructions: instructions.next(),
        })
    };
    rungs.into_iter().map(measure).collect()
}

/// Cost and error of a rung (a model or setting). Smaller values are better.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CostError {
    /// Number of processor instructions, or time in nanoseconds if instructions were not counted.
    cost: f64,
    error: f64,
}

/// The costs of two models or settings count as equal if the ratio of the larger to the smaller cost is at most this
/// number.
const EQUAL_COST_RATIO: f64 = 1.02;
/// Errors of models or settings below this value are caused by rounding, so they count as equal.
const ROUNDING: f64 = 1e-14;

/// For each rung (model or setting): whether it is on the Pareto front. A rung is on the front if no other rung
/// dominates it. One rung dominates another if its cost and its error are at most as large, and at least one of them is
/// smaller. Of several rungs with equal cost and error, only the first can be on the front.
fn pareto(rungs: &[CostError]) -> Vec<bool> {
    let beats = |a: usize, b: usize| {
        let ([a_cost, b_cost], [a_error, b_error]) = (
            [a, b].map(|one| rungs[one].cost),
            [a, b].map(|one| rungs[one].error.max(ROUNDING)),
        );
        let (no_dearer, cheaper) = (
            a_cost <= EQUAL_COST_RATIO * b_cost,
            EQUAL_COST_RATIO * a_cost < b_cost,
        );
        let better = cheaper || a_error < b_error;
        let equal = b_cost <= EQUAL_COST_RATIO * a_cost && a_error == b_error;
        no_dearer && a_error <= b_error && (better || equal && a < b)
    };
    (0..rungs.len())
        .map(|one| !(0..rungs.len()).any(|other| beats(other, one)))
        .collect()
}

/// Index of the cheapest rung (model or setting) on the Pareto front whose error is at most `target`.
fn answer(rungs: &[CostError], target: f64) -> Option<usize> {
    let on_front = pareto(rungs);
    let adequate = |rung: &usize| on_front[*rung] && rungs[*rung].error <= target;
    (0..rungs.len())
        .filter(adequate)
        .min_by(|&a, &b| rungs[a].cost.total_cmp(&rungs[b].cost))
}
