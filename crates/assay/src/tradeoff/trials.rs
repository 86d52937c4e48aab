//! Rungs that are scenes of a config: what a trial costs, and how far trials err.

use palpate_scene::Scenes;
use std::cell::OnceCell;

use anyhow::{Context, Result, anyhow, ensure};
use palpate_scene::{Outcome, Scene};
use palpate_study::config;

use super::ladder::{Ease, Erring, Rung, SceneRungs};

/// Placeholder in a scene's text for the lines of a rung.
const RUNG: &str = "$rung";

/// A scene's text, in which every rung stands in turn.
pub(super) struct Template {
    pub(super) ease: Ease,
    /// Words for the scene.
    pub(super) scene: &'static str,
    /// TOML of `[scene]` with a `$rung` in it.
    pub(super) text: String,
}

impl Template {
    /// An easy, a typical and a hard scene: what all have in common, and the words and the lines of each.
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

/// An easy, a typical and a hard scene with the same rungs. `common` is the config text of all three; `own` is the
/// description and the additional text of each.
pub(super) fn scenes(
    common: &str,
    own: [(&'static str, &str); 3],
    choices: &[Choice],
    asked: Asked,
) -> Vec<SceneRungs> {
    let templates = Template::all(common, own);
    let stage = |scene: &Template| scene.stage(choices, asked);
    templates.iter().map(stage).collect()
}

/// Text that a rung puts in place of `$rung`.
pub(super) struct Choice {
    pub(super) name: String,
    pub(super) setting: Option<f64>,
    pub(super) text: String,
    /// Text of a scene whose trials cost the same but which is sooner set up, to be timed instead, where there is one.
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

/// How trials become a number.
#[derive(Clone, Copy)]
pub(super) struct Asked {
    /// Computation of the error of a number of trials.
    pub(super) error: fn(&Scene, trials: u64) -> Result<Erring>,
    /// Trials for the error.
    pub(super) trials: u64,
    /// Trials in a row that are timed, so that their cost is a mean.
    pub(super) timed: u32,
}

impl Template {
    pub(super) fn stage(&self, choices: &[Choice], asked: Asked) -> SceneRungs {
        let rungs = choices.iter().map(|choice| {
            let errs = self.text.replace(RUNG, &choice.text);
            let timed = choice.evaluated.as_ref().unwrap_or(&choice.text);
            let text = self.text.replace(RUNG, timed);
            let evaluated_text = text.clone();
            let error = move || {
                if evaluated_text != errs {
                    scene_of(&evaluated_text)?;
                }
                (asked.error)(&scene_of(&errs)?, asked.trials)
            };
            let rung = Rung::new(choice.name.as_str(), error, evaluated(text, asked.timed));
            rung.in_a_row(asked.timed).set(choice.setting)
        });
        SceneRungs {
            ease: self.ease,
            scene: self.scene.to_owned(),
            rungs: rungs.collect(),
        }
    }
}

/// The scene of a text that has one cell.
pub(super) fn scene_of(text: &str) -> Result<Scene> {
    let study = format!("name = \"rung\"\nseed = 1996\ntrials = 1\n[scene]\n{text}");
    let study = config::parse("rung", &study).with_context(|| text.to_owned())?;
    study.estimable_scene(0).with_context(|| text.to_owned())
}

/// Trials of the scene of a text, which is made at the first run. A scene that cannot be made costs nothing; whoever
/// asks for the cost has to ask [`scene_of`] as well.
pub(super) fn evaluated(text: String, trials: u32) -> impl FnMut() -> Option<f64> + 'static {
    let scene = OnceCell::new();
    move || {
        let scene = scene.get_or_init(|| scene_of(&text).ok());
        scene.as_ref().map(|scene| run(scene, trials))
    }
}

/// Runs trials as a study does, and adds up what they estimate. Trials that fail cost what they cost.
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
        // What failed has nothing to add.
        let _ = scene.trial(trial, |_, outcome| sum += outcome.estimate);
    }
    sum
}

/// Root mean square of the relative error of one quantity; a trial that fails errs by its whole truth.
pub(super) fn relative_rms(scene: &Scene, quantity: usize, trials: u64) -> Result<Erring> {
    let truth = scene.truth(quantity).context("there is no one truth")?;
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

/// Root r of the mean of N squared errors, one of each trial, with its standard error s/√N/(2r), where s is the standard
/// deviation of the squares.
pub(super) fn root_mean(squares: &[f64]) -> Result<Erring> {
    ensure!(!squares.is_empty(), "no trials");
    let count = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / count;
    let error = at_least_rounding(mean.sqrt())?;
    let std = (squares.len() > 1).then(|| {
        let scatter = squares.iter().map(|one| (one - mean).powi(2)).sum::<f64>();
        (scatter / (count - 1.0) / count).sqrt() / (2.0 * error)
    });
    Ok(Erring { error, std })
}

/// Outcomes of each trial, with their quantities. A trial that fails estimates 0, and so errs by its whole truth.
pub(super) fn outcomes(scene: &Scene, trials: u64) -> Result<Vec<Vec<(usize, Outcome)>>> {
    let tried = (0..scene.trials(trials)).map(|trial| {
        let mut outcomes = Vec::new();
        let done = scene.trial(trial, |index, outcome| outcomes.push((index, outcome)));
        done.ok().map(|()| outcomes)
    });
    let tried: Vec<Option<Vec<(usize, Outcome)>>> = tried.collect();
    let succeeded = tried.iter().flatten().next();
    let mut failed = succeeded.context("every trial failed")?.clone();
    for (_, outcome) in &mut failed {
        outcome.estimate = 0.0;
    }
    let tried = tried.into_iter();
    Ok(tried
        .map(|outcomes| outcomes.unwrap_or_else(|| failed.clone()))
        .collect())
}

/// No error is told from one that is as large as a rounding unit.
pub(super) fn at_least_rounding(error: f64) -> Result<f64> {
    if error.is_finite() {
        Ok(error.max(f64::EPSILON))
    } else {
        Err(anyhow!("the error is {error}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_mean_square_has_the_standard_error_of_its_trials() {
        // Squares 1 and 9: mean 5, s = √32, r = √5; s/√2/(2r) = 2/√5.
        let rms = root_mean(&[1.0, 9.0]).unwrap();
        assert!((rms.error - 5_f64.sqrt()).abs() < 1e-15);
        assert!((rms.std.unwrap() - 2.0 / 5_f64.sqrt()).abs() < 1e-15);
        assert_eq!(root_mean(&[4.0]).unwrap(), 2.0.into());
        assert!(root_mean(&[]).is_err());
    }
}
