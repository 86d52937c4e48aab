//! Trials: the models that a scene needs, and the way from its truth over a reading to an estimate.
//!
//! This is the only place where the truth of a trial and its estimate meet. [`Scenes`] builds the [`Scene`] of a cell of a
//! study, whose [`Scene::trial`] simulates a contact, reads it with a sensor and estimates from the reading. [`recorded`]
//! estimates from readings that somebody measured.

pub mod fingertip;
pub mod glide;
mod ladder;
mod plan;
pub mod press;
pub mod recorded;
pub mod roll;
mod tracks;

pub use fingertip::FingertipScene;
pub use glide::GlideScene;
pub use ladder::{Ladder, Rung};
pub use palpate_rolling::TOLERANCES;
pub use plan::PlanError;
pub use press::PressScene;
pub use roll::{Arch, LANES, RollScene, SideBySide};

use palpate_study::Quantity;
use palpate_study::config::{ConfigError, SceneConfig, Study};

/// A scene that is ready to run.
///
/// ```
/// use palpate_scene::Scenes;
/// use palpate_study::config::parse;
///
/// let text = r#"
///     name = "roll-on-a-ball"
///     scene.kind = "roll"
///     scene.probe = { kind = "sphere", radius = 1.0 }
///     scene.object = { kind = "sphere", radius = 4.0 }
///     scene.motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// "#;
/// let scene = parse("study.toml", text)?.estimable_scene(0)?;
/// assert_eq!(scene.quantities()[0].name, "normal_curvature_u");
/// // Without noise the curvature of a ball is exact: 1/4.
/// let mut estimates = Vec::new();
/// scene.trial(0, |_, outcome| estimates.push(outcome.estimate))?;
/// assert!((estimates[0] - 0.25).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one per cell")]
pub enum Scene {
    /// A probe rolls on an object.
    Roll(RollScene),
    /// Fingers slide over a patch.
    Glide(GlideScene),
    /// A soft sphere is pressed onto an object.
    Press(PressScene),
    /// A soft sphere with markers touches nothing.
    Fingertip(FingertipScene),
}

/// One trial's estimate of a quantity, and its truth, in the quantity's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The estimate.
    pub estimate: f64,
    /// The truth.
    pub truth: f64,
    /// The standard deviation that the estimator states; `None` if it states none.
    pub std: Option<f64>,
    /// Whether the 95 % interval that the estimator states holds the truth; `None` where it is the
    /// estimate ± 1.96 std.
    pub interval_holds: Option<bool>,
}

impl Scene {
    /// Quantities that the scene estimates, in the order of the indices that [`Scene::trial`] reports.
    pub fn quantities(&self) -> &'static [Quantity] {
        match self {
            Self::Roll(_) => &roll::QUANTITIES,
            Self::Glide(_) => &glide::QUANTITIES,
            Self::Press(press) => press.quantities(),
            Self::Fingertip(fingertip) => fingertip.quantities(),
        }
    }

    /// How many trials make sense: `wanted`, or one if nothing in the scene is random.
    pub fn trials(&self, wanted: u64) -> u64 {
        match self {
            Self::Roll(roll) if !roll.is_random() => 1,
            Self::Glide(glide) if !glide.is_random() => 1,
            Self::Press(press) if !press.is_random() => 1,
            Self::Fingertip(_) => 1,
            Self::Roll(_) | Self::Glide(_) | Self::Press(_) => wanted,
        }
    }

    /// Runs trial number `trial` and reports outcomes with their quantity's index: one of each
    /// quantity, or one at each place of a patch.
    ///
    /// # Errors
    /// The stable name of what went wrong; nothing of a failed trial counts.
    #[inline]
    pub fn trial(
        &self,
        trial: u64,
        observe: impl FnMut(usize, Outcome),
    ) -> Result<(), &'static str> {
        match self {
            Self::Roll(roll) => roll.trial(trial, observe),
            Self::Glide(glide) => glide.trial(trial, observe),
            Self::Press(press) => press.trial(trial, observe),
            Self::Fingertip(fingertip) => fingertip.trial(observe),
        }
    }

    /// The true value of the quantity with this index, where it is the same everywhere.
    pub fn truth(&self, quantity: usize) -> Option<f64> {
        match self {
            Self::Roll(roll) => roll.truths().get(quantity).copied(),
            Self::Glide(glide) => glide.truth(quantity),
            Self::Press(press) => press.truth(quantity),
            Self::Fingertip(fingertip) => fingertip.truth(quantity),
        }
    }

    /// The Cramér–Rao bound on the standard deviation of an estimate of the quantity with this
    /// index, where it is known: of presses with noise.
    pub fn std_bound(&self, quantity: usize) -> Option<f64> {
        match self {
            Self::Roll(_) | Self::Glide(_) | Self::Fingertip(_) => None,
            Self::Press(press) => press.std_bound(quantity),
        }
    }

    /// The models that the scene needs and why, one line each.
    pub fn needs(&self) -> Vec<String> {
        match self {
            Self::Roll(roll) => roll.needs(),
            Self::Glide(glide) => glide.needs(),
            Self::Press(press) => press.needs(),
            Self::Fingertip(fingertip) => fingertip.needs(),
        }
    }
}

/// Scenes of a study's cells.
pub trait Scenes {
    /// Builds the scene of a cell.
    ///
    /// # Errors
    /// A [`ConfigError`] at the field that makes no scene: a pitch larger than the probe, a formula
    /// with a syntax error, a first contact off the object.
    ///
    /// # Panics
    /// If `cell` is not the index of a cell.
    fn scene(&self, cell: usize) -> Result<Scene, ConfigError>;

    /// Builds the scene of a cell, if it can be estimated from. A trace needs no such scene.
    ///
    /// # Errors
    /// Errors of [`Scenes::scene`], and where the readings cannot tell the curvature: fewer than two probes,
    /// or all parallel; too few contacts, or all on a line; too few markers.
    ///
    /// # Panics
    /// If `cell` is not the index of a cell.
    fn estimable_scene(&self, cell: usize) -> Result<Scene, ConfigError>;

    /// Builds the scene of a cell on another rung of its ladder.
    ///
    /// # Errors
    /// Errors of [`Scenes::scene`]: where the rung cannot do the scene, at `scene.model`.
    ///
    /// # Panics
    /// If `cell` is not the index of a cell.
    fn with_model(&self, cell: usize, rung: &Rung) -> Result<Scene, ConfigError>;

    /// Measures the ladder of a cell's scene; there is none of one that touches nothing.
    ///
    /// # Errors
    /// Errors of [`Scenes::estimable_scene`].
    ///
    /// # Panics
    /// If `cell` is not the index of a cell.
    fn ladder(&self, cell: usize) -> Result<Option<Ladder>, ConfigError> {
        self.ladder_of(cell, &self.estimable_scene(cell)?)
    }

    /// Measures the ladder of a cell whose scene has been made.
    ///
    /// # Errors
    /// Where the model of another scene than the cell's cannot do what the cell asks for.
    ///
    /// # Panics
    /// If `cell` is not the index of a cell.
    fn ladder_of(&self, cell: usize, scene: &Scene) -> Result<Option<Ladder>, ConfigError>;
}

impl Scenes for Study {
    fn scene(&self, cell: usize) -> Result<Scene, ConfigError> {
        let config = &self.cells[cell].config;
        built(self, cell, &config.scene, config.seed)
    }

    fn estimable_scene(&self, cell: usize) -> Result<Scene, ConfigError> {
        let scene = self.scene(cell)?;
        match &scene {
            Scene::Roll(roll) => roll.estimable(),
            Scene::Glide(glide) => glide.estimable(),
            Scene::Press(press) => press.estimable(),
            Scene::Fingertip(_) => Ok(()),
        }
        .map_err(|error| located(self, cell, error))?;
        Ok(scene)
    }

    fn with_model(&self, cell: usize, rung: &Rung) -> Result<Scene, ConfigError> {
        let config = &self.cells[cell].config;
        match config.scene.with_model(&rung.model) {
            Some(scene) => built(self, cell, &scene, config.seed),
            None => {
                let message = format!("{} is no model of this kind of scene", rung.name);
                Err(self.error_at(cell, "scene.model", message))
            }
        }
    }

    fn ladder_of(&self, cell: usize, scene: &Scene) -> Result<Option<Ladder>, ConfigError> {
        let config = &self.cells[cell].config.scene;
        Ok(match (scene, config) {
            (Scene::Roll(scene), SceneConfig::Roll(config)) => Some(scene.ladder(config)),
            (Scene::Glide(_), SceneConfig::Glide(config)) => {
                let ladder = GlideScene::ladder(config);
                Some(ladder.map_err(|error| located(self, cell, error))?)
            }
            (Scene::Press(scene), SceneConfig::Press(config)) => {
                let ladder = scene.ladder(config);
                Some(ladder.map_err(|error| located(self, cell, error))?)
            }
            _ => None,
        })
    }
}

/// Builds the scene that stands for that of a cell.
fn built(
    study: &Study,
    cell: usize,
    config: &SceneConfig,
    seed: u64,
) -> Result<Scene, ConfigError> {
    match config {
        SceneConfig::Roll(roll) => RollScene::new(roll, seed).map(Scene::Roll),
        SceneConfig::Glide(glide) => GlideScene::new(glide, seed).map(Scene::Glide),
        SceneConfig::Press(press) => PressScene::new(press, seed).map(Scene::Press),
        SceneConfig::Fingertip(fingertip) => FingertipScene::new(fingertip).map(Scene::Fingertip),
    }
    .map_err(|error| located(study, cell, error))
}

/// Error of a plan with its place in the config's text.
fn located(study: &Study, cell: usize, error: PlanError) -> ConfigError {
    match error.part {
        Some(part) => study.error_in_text(cell, &error.path, part, error.message),
        None => study.error_at(cell, &error.path, error.message),
    }
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
