//! Error against a trusted truth and cost per evaluation, for every ladder of the system.
//!
//! | ladder | truth |
//! |---|---|
//! | rolling | closed forms of a ball and a paraboloid; on the ellipsoid, integrators in charts, whose equations are others |
//! | gliding | the offset surface of a ball, a saddle, an ellipsoid |
//! | pads, probes, fits, maps | the object's curvature, in closed form |
//! | press models | quadrature over wavenumbers: [`crate::pressed`] |
//! | press sensors, press estimators | the effective radius that was pressed with |
//! | Monte Carlo | the standard error, from the trials' own scatter |

mod front;
mod glides;
mod ladder;
mod monte_carlo;
mod pads;
mod patches;
mod press_estimators;
mod press_models;
mod press_sensors;
mod probes;
mod rolling;
mod stages;
mod table;
mod trials;

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};

use crate::measured::{self, Evaluation};
use ladder::{Ladder, SceneRungs};
use table::{Measured, MeasuredRung};

/// How a run is made.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// The folder to write to.
    pub out: &'a Path,
    /// Table that [`tallies`] has written.
    pub tallies: &'a Path,
    /// Words for the machine on which costs are measured.
    pub machine: &'a str,
    /// Whether to time each rung only briefly.
    pub quick: bool,
    /// Count the evaluations for [`measured::instructions`], and do nothing else.
    pub counted: bool,
}

/// All ladders, in the order of the pipeline.
fn ladders() -> Result<Vec<Ladder>> {
    Ok(vec![
        rolling::ladder()?,
        glides::ladder(),
        pads::ladder(),
        probes::ladder(),
        patches::fits(),
        patches::maps(),
        press_models::ladder(),
        press_sensors::ladder(),
        press_estimators::ladder(),
        monte_carlo::ladder(),
    ])
}

/// Measures every ladder and writes `ladders.csv`, `rungs.csv`, `answers.csv` and `stages.csv`. `tell` is told what is
/// under way.
///
/// # Errors
/// If a rung fails on its scene, counting fails, or a table cannot be written.
pub fn run(options: Options<'_>, tell: impl Fn(&str)) -> Result<()> {
    let ladders = ladders()?;
    let stages = stages::stages();
    let of_stages = stages.iter().map(stages::Stage::evaluation);
    if options.counted {
        let of_rungs = ladders.into_iter().flat_map(|ladder| ladder.scenes);
        let of_rungs = of_rungs.flat_map(|stage| stage.rungs);
        measured::count(of_rungs.map(|rung| rung.evaluation).chain(of_stages));
        return Ok(());
    }
    std::fs::create_dir_all(options.out)
        .with_context(|| format!("cannot make {}", options.out.display()))?;
    tell("counting instructions");
    let scale = rungs(&ladders).chain(of_stages.map(|one| one.scale()));
    let counts = measured::instructions(&scale.collect::<Vec<u32>>())?;
    if counts.is_none() {
        tell(measured::NO_VALGRIND);
    }
    let patience = Duration::from_millis(if options.quick { 10 } else { 250 });
    let rung_count = rungs(&ladders).count();
    let mut of_rungs = counts
        .iter()
        .flat_map(|counts| counts[..rung_count].iter().copied());
    let mut all = Vec::new();
    for ladder in ladders {
        tell(ladder.name);
        for stage in ladder.scenes {
            let rungs = measure(stage.rungs, &mut of_rungs, patience)
                .with_context(|| format!("{} on {}", ladder.name, stage.scene))?;
            all.push(Measured {
                ladder: ladder.name,
                title: ladder.title,
                error: ladder.error,
                evaluation: ladder.evaluation,
                ease: stage.ease,
                scene: stage.scene,
                rungs,
            });
        }
    }
    table::write(&all, options.machine, options.out)?;
    tell("stages");
    let of_stages = counts.as_ref().map(|counts| &counts[rung_count..]);
    let tallies = stages::read_tallies(options.tallies)?;
    stages::write(&stages, of_stages, &tallies, patience, options.out)
}

/// Writes what one trial of each stage does. Costs are measured by another build of this program, which counts nothing.
///
/// # Errors
/// If a stage makes no scene, or the table cannot be written.
#[cfg(feature = "count")]
pub fn tallies(out: &Path) -> Result<()> {
    stages::write_tallies(out)
}

/// How many evaluations a run of each rung is.
fn rungs(ladders: &[Ladder]) -> impl Iterator<Item = u32> {
    let stages = ladders.iter().flat_map(|ladder: &Ladder| &ladder.scenes);
    stages.flat_map(|stage: &SceneRungs| stage.rungs.iter().map(|rung| rung.evaluation.scale()))
}

fn measure(
    rungs: Vec<ladder::Rung>,
    instructions: &mut impl Iterator<Item = u64>,
    patience: Duration,
) -> Result<Vec<MeasuredRung>> {
    let measure = |rung: ladder::Rung| {
        // First, for it tells whether there is anything to evaluate.
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
