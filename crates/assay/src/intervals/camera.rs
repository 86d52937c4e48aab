//! Coverage of the intervals of presses with a camera, by the image fit: of layers that the fit assumes, and of other
//! bodies. The parameters of the sensor are redrawn in every trial, within the stated accuracy of its calibration.

use anyhow::{Result, bail};
use palpate_scene::{PressScene, Scene, Scenes, SharedModels};
use palpate_study::config::parse;
use rayon::prelude::*;

use super::camera_case::{Case, Family};
use super::camera_score::{Estimate, score};
use super::{Options, case_scores};

pub use super::camera_score::{Score, Summary};

/// Number of trials with the same place of the contact.
const BLOCK: u64 = 5;

/// Scores of all scenes. `report` gets each as soon as it is computed.
///
/// # Errors
/// If a scene cannot be set up, or `report` fails.
pub fn scores(options: Options<'_>, report: impl Fn(&Score) -> Result<()>) -> Result<Vec<Score>> {
    let numbers = || 0..options.scenes;
    let cases = Family::ALL
        .into_iter()
        .flat_map(|family| numbers().map(move |number| Case::random(family, options.seed, number)));
    case_scores(cases, Case::name, options, report, |case| {
        Ok([scene_score(case, options)?])
    })
}

/// Summaries of the families with scores.
pub fn summaries(scores: &[Score]) -> Vec<Summary> {
    let of_family = |family: Family| {
        let of_family = scores.iter().filter(|score| score.family == family.name());
        Summary::new(family, &of_family.collect::<Vec<_>>())
    };
    Family::ALL.into_iter().filter_map(of_family).collect()
}

fn scene_score(case: &Case, options: Options<'_>) -> Result<Score> {
    let parts = SharedModels::default();
    let pixel_bound = press(case, 0, options.seed, &parts)?.pixel_std_bound();
    let trials = case.family.trials(options.trials);
    let estimates_of_block = |block: u64| -> Result<Vec<Estimate>> {
        let scene = press(case, block, options.seed, &parts)?;
        let estimate = |trial| match case.family {
            Family::Calibrated => scene.calibrated_curvature_score(trial),
            _ => scene.curvature_score(trial),
        };
        let trials = block * BLOCK..trials.min((block + 1) * BLOCK);
        Ok(trials
            .map(|trial| estimate(trial).map_err(|error| error.name()))
            .collect())
    };
    let blocks = (0..trials.div_ceil(BLOCK)).into_par_iter();
    let estimates: Vec<Vec<Estimate>> = blocks.map(estimates_of_block).collect::<Result<_>>()?;
    let estimates: Vec<Estimate> = estimates.into_iter().flatten().collect();
    Ok(score(case, &estimates, pixel_bound))
}

/// The press of a case with the contact of a block of trials.
fn press(case: &Case, block: u64, seed: u64, parts: &SharedModels) -> Result<PressScene> {
    let study = parse("camera.toml", &case.config(seed, block))?;
    match study.estimable_scene_of(0, &study.cell(0)?, parts)? {
        Scene::Press(press) => Ok(press),
        _ => bail!("a case is not a press"),
    }
}

/// Configs of random presses, with the name of their family in the coverage table.
#[cfg(test)]
pub(super) fn configs() -> Vec<(String, String)> {
    let cases = (0..50).map(|number| Case::random(Family::Sound, 7, number));
    cases
        .map(|case| (case.coverage_family(), case.config(7, 1)))
        .collect()
}
