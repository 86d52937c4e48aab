//! Random presses before a camera, and how many of the objects' curvatures are within the intervals that the fit of
//! pictures states: of bodies that the fit knows, and of others. Every trial has another sensor, within what its
//! calibration states.

mod case;
mod score;
mod summary;

pub use score::Score;
pub use summary::Summary;

use anyhow::{Result, bail};
use palpate_scene::{Parts, PressScene, Scene, Scenes};
use palpate_study::config::parse;
use rayon::prelude::*;

use super::options::Options;
use case::{Case, Family};
use score::Judged;

/// Name of the family of presses by sensors that are as the fit believes.
pub(super) const SOUND: &str = Family::Sound.name();

/// Trials that share the place of the contact.
const JITTERED: u64 = 5;

/// The scores of all scenes; `say` is told each as it is known.
///
/// # Errors
/// A scene that cannot be asked.
pub fn scores(options: Options<'_>, say: impl Fn(&Score)) -> Result<Vec<Score>> {
    let mut scores = Vec::new();
    for family in Family::ALL {
        for number in 0..options.scenes {
            let case = Case::random(family, options.seed, number);
            let name = case.name();
            let is_asked = options
                .only
                .split_whitespace()
                .all(|word| name.contains(word));
            if is_asked {
                let score = score(&case, options)?;
                say(&score);
                scores.push(score);
            }
        }
    }
    Ok(scores)
}

/// The summaries of the families that have scores.
pub fn summaries(scores: &[Score]) -> Vec<Summary> {
    let of_family = |family: Family| -> Option<Summary> {
        let of_family = scores.iter().filter(|score| score.family == family.name());
        Summary::of(family, &of_family.collect::<Vec<_>>())
    };
    Family::ALL.into_iter().filter_map(of_family).collect()
}

fn score(case: &Case, options: Options<'_>) -> Result<Score> {
    let parts = Parts::default();
    let pixel_bound = press(case, 0, options.seed, &parts)?.pixel_std_bound();
    let trials = case.family.trials(options.trials);
    let of_block = |block: u64| -> Result<Vec<Judged>> {
        let scene = press(case, block, options.seed, &parts)?;
        let numbers = block * JITTERED..trials.min((block + 1) * JITTERED);
        Ok(numbers.map(|trial| trial_of(&scene, case, trial)).collect())
    };
    let blocks = (0..trials.div_ceil(JITTERED)).into_par_iter();
    let blocks = blocks.map(of_block).collect::<Result<Vec<_>>>()?;
    let judged: Vec<Judged> = blocks.into_iter().flatten().collect();
    Ok(score::score(case, &judged, pixel_bound))
}

fn trial_of(scene: &PressScene, case: &Case, trial: u64) -> Judged {
    let judged = match case.family {
        Family::Calibrated => scene.calibrated_curvature(trial),
        _ => scene.judged_curvature(trial),
    };
    judged.map_err(|error| error.name())
}

/// The press of a case with the contact of a block of trials.
fn press(case: &Case, block: u64, seed: u64, parts: &Parts) -> Result<PressScene> {
    let study = parse("camera.toml", &case.text(seed, block))?;
    match study.estimable_scene_of(0, &study.cell(0)?, parts)? {
        Scene::Press(press) => Ok(press),
        _ => bail!("a case is no press"),
    }
}

/// Random presses as configs, with the name of their family.
#[cfg(test)]
pub(super) fn texts() -> Vec<(String, String)> {
    let cases = (0..50).map(|number| Case::random(Family::Sound, 7, number));
    let named = |case: Case| {
        let known = if case.fits_indentation {
            "fitted"
        } else {
            "known"
        };
        let name = format!("pictures of layers, indentation {known}");
        (name, case.text(7, 1))
    };
    cases.map(named).collect()
}
