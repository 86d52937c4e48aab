//! Measures models and settings (rungs of a ladder) that are chosen in the config of a scene: the cost and the error of
//! the scene's trials.

use std::cell::OnceCell;

use anyhow::{Context, Result, anyhow, ensure};
use palpate_scene::{Scene, Scenes};
use palpate_study::config;
use palpate_sweep::Observation;

use super::ladder::{Ease, Rung, RungError, SceneRungs};

/// Placeholder in the config text of a scene. For each rung of the ladder (compared model or setting), the config lines
/// of this rung replace the placeholder.
const RUNG: &str = "$rung";

/// Config text of a scene, with a placeholder for the config lines of the compared model or setting.
pub(super) struct Template {
    pub(super) ease: Ease,
    pub(super) scene: &'static str,
    /// TOML text of `[scene]` with the placeholder `$rung`.
    pub(super) text: String,
}

impl Template {
    /// Creates the config texts of three scenes: an easy, a typical and a hard one. All three contain the lines
    /// `common`. `own` contains the description and the additional lines of each scene.
    pub(super) fn all(common: &str, own: [(&'static str, &str); 3]) -> Vec<Self> {
        let eases = [Ease::Easy, Ease::Typical, Ease::Hard];
        let scenes = eases.into_iter().zip(own);
        scenes
            .map(|(ease, (scene, own))| Self {
                ease,
                scene,
                text: format!("{common}{own}"),
            })
            .collect()
    }
}

/// Three scenes (easy, typical and hard), each with all of the compared models or settings. The arguments `common` and
/// `own` are those of [`Template::all`].
pub(super) fn scenes(
    common: &str,
    own: [(&'static str, &str); 3],
    choices: &[Choice],
    measure: Measure,
) -> Vec<SceneRungs> {
    let templates = Template::all(common, own);
    let stage = |scene: &Template| scene.stage(choices, measure);
    templates.iter().map(stage).collect()
}

/// A rung (model or setting), with the text that replaces `$rung` in the config text of a scene.
pub(super) struct Choice {
    pub(super) name: String,
    pub(super) setting: Option<f64>,
    pub(super) text: String,
    /// Text that replaces `$rung` when the cost is measured, if it differs from `text`. A trial costs the same with
    /// both texts, but the scene is set up faster with this text.
    pub(super) evaluated: Option<String>,
}

impl Choice {
    pub(super) fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            setting: None,
            text: text.into(),
            evaluated: None,
        }
    }

    pub(super) fn set(self, setting: f64) -> Self {
        Self {
            setting: Some(setting),
            ..self
        }
    }
}

/// How the error and the cost of a rung (model or setting) are measured.
#[derive(Clone, Copy)]
pub(super) struct Measure {
    /// Computes the error of the scene's estimates from `trials` trials.
    pub(super) error: fn(&Scene, trials: u64) -> Result<RungError>,
    /// Number of trials from which the error of a model or setting is computed.
    pub(super) trials: u64,
    /// Number of trials over which the cost of a model or setting is averaged.
    pub(super) timed: u32,
}

impl Template {
    pub(super) fn stage(&self, choices: &[Choice], measure: Measure) -> SceneRungs {
        let rungs = choices.iter().map(|choice| {
            let errs = self.text.replace(RUNG, &choice.text);
            let timed = choice.evaluated.as_ref().unwrap_or(&choice.text);
            let text = self.text.replace(RUNG, timed);
            let evaluated_text = text.clone();
            let error = move || {
                if evaluated_text != errs {
                    scene_of(&evaluated_text)?;
                }
                (measure.error)(&scene_of(&errs)?, measure.trials)
            };
            let rung = Rung::new(choice.name.as_str(), error, evaluated(text, measure.timed));
            rung.evaluations_per_run(measure.timed).set(choice.setting)
        });
        SceneRungs::new(self.ease, self.scene, rungs.collect())
    }
}

/// The scene with the config text `text`, which must not sweep any field.
pub(super) fn scene_of(text: &str) -> Result<Scene> {
    let study = format!("name = \"rung\"\nseed = 1996\ntrials = 1\n[scene]\n{text}");
    let study = config::parse("rung", &study).with_context(|| text.to_owned())?;
    study.estimable_scene(0).with_context(|| text.to_owned())
}

/// Returns a function that runs `trials` trials of the scene with the config text `text`, and sets up the scene in its
/// first call. If the text is invalid, the function does nothing, so check the text with [`scene_of`] first.
pub(super) fn evaluated(text: String, trials: u32) -> impl FnMut() -> Option<f64> + 'static {
    let scene = OnceCell::new();
    move || {
        let scene = scene.get_or_init(|| scene_of(&text).ok());
        scene.as_ref().map(|scene| run(scene, trials))
    }
}

/// Runs trials as a study does. Returns the sum of all estimates, so that the compiler cannot omit the trials.
pub(super) fn run(scene: &Scene, trials: u32) -> f64 {
    let trials = u64::from(trials);
    let mut sum = 0.0;
    let together = match scene {
        Scene::Roll(roll) => roll.side_by_side(palpate_scene::Arch::new(), 0..trials, |observed| {
            let estimates = observed[0].estimates;
            sum += estimates.iter().sum::<f64>();
            estimates.len()
        }),
        _ => 0,
    };
    for trial in together..trials {
        // A failed trial has no estimate, so it adds nothing to the sum.
        let _ = scene.trial(trial, |_, outcome| sum += outcome.estimate);
    }
    sum
}

/// Root mean square of the relative errors of one quantity over all trials. The relative error of a failed trial counts
/// as 1.
pub(super) fn relative_rms(scene: &Scene, quantity: usize, trials: u64) -> Result<RungError> {
    let truth = scene
        .truth(quantity)
        .context("the quantity has no single true value")?;
    let squares = (0..scene.trials(trials)).map(|trial| {
        let mut error = truth;
        let _ = scene.trial(trial, |index, outcome| {
            if index == quantity {
                error = outcome.estimate - outcome.truth;
            }
        });
        (error / truth).powi(2)
    });
    root_mean(&squares.collect::<Vec<f64>>())
}

/// Root mean square r of N errors, computed from their squares. The standard error of r is s/(2r√N), where s is the
/// standard deviation of the squares.
pub(super) fn root_mean(squares: &[f64]) -> Result<RungError> {
    ensure!(!squares.is_empty(), "no trials");
    let count = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / count;
    let error = at_least_rounding(mean.sqrt())?;
    let std = (squares.len() > 1).then(|| {
        let scatter = squares.iter().map(|one| (one - mean).powi(2)).sum::<f64>();
        (scatter / (count - 1.0) / count).sqrt() / (2.0 * error)
    });
    Ok(RungError { error, std })
}

/// For each trial, the estimates and true values, each with the index of its quantity. In a failed trial, all estimates
/// are set to 0, so the relative error is 1.
pub(super) fn outcomes(scene: &Scene, trials: u64) -> Result<Vec<Vec<(usize, Observation)>>> {
    let attempts = (0..scene.trials(trials)).map(|trial| {
        let mut outcomes = Vec::new();
        let done = scene.trial(trial, |index, outcome| outcomes.push((index, outcome)));
        done.ok().map(|()| outcomes)
    });
    let attempts: Vec<Option<Vec<(usize, Observation)>>> = attempts.collect();
    let succeeded = attempts.iter().flatten().next();
    let mut failed = succeeded.context("every trial failed")?.clone();
    for (_, outcome) in &mut failed {
        outcome.estimate = 0.0;
    }
    Ok(attempts
        .into_iter()
        .map(|outcomes| outcomes.unwrap_or_else(|| failed.clone()))
        .collect())
}

/// The larger of `error` and the rounding error of a double (`f64`), because smaller errors are not significant.
pub(super) fn at_least_rounding(error: f64) -> Result<f64> {
    if error.is_finite() {
        Ok(error.max(f64::EPSILON))
    } else {
        Err(anyhow!("the error is {error}"))
    }
}
