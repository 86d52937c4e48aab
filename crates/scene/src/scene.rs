//! Scenes of any kind, and the scenes of a study's cells.

use std::ops::Deref;

use palpate_study::Quantity;
use palpate_study::config::{Cell, ConfigError, SceneConfig, Study};

use crate::glide::GlideScene;
use crate::ladder::{Ladder, Rung};
use crate::measured_sensor::MeasuredSensor;
use crate::press::{Parts, PressScene};
use crate::roll::RollScene;
use crate::trials::{Outcome, Trials};
use palpate_study::FieldError;

/// A scene that is ready to run: [`Trials`] of one kind.
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
    /// A sensor without contact, whose properties are computed.
    Sensor(MeasuredSensor),
}

impl Deref for Scene {
    type Target = dyn Trials;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Roll(roll) => roll,
            Self::Glide(glide) => glide,
            Self::Press(press) => press,
            Self::Sensor(sensor) => sensor,
        }
    }
}

/// Quantities of a config's scene, as [`Trials::quantities`] returns them, without building the scene.
pub fn quantities_of(config: &SceneConfig) -> &'static [Quantity] {
    match config {
        SceneConfig::Roll(_) => &RollScene::QUANTITIES,
        SceneConfig::Glide(_) => &GlideScene::QUANTITIES,
        SceneConfig::Press(press) => PressScene::quantities_of(press),
        SceneConfig::Fingertip(sensor) => MeasuredSensor::quantities_of(&sensor.probe),
    }
}

impl Scene {
    /// Builds the scene of a config; `seed` seeds its random numbers.
    ///
    /// # Errors
    /// [`FieldError`] with the path of the invalid field.
    pub fn new(config: &SceneConfig, seed: u64) -> Result<Self, FieldError> {
        Self::of(config, seed, &Parts::default())
    }

    /// Builds the scene of a config. `seed` seeds its random numbers; other scenes may share `parts`.
    ///
    /// # Errors
    /// Errors of [`Scene::new`].
    pub fn of(config: &SceneConfig, seed: u64, parts: &Parts) -> Result<Self, FieldError> {
        match config {
            SceneConfig::Roll(roll) => RollScene::new(roll, seed).map(Self::Roll),
            SceneConfig::Glide(glide) => GlideScene::new(glide, seed).map(Self::Glide),
            SceneConfig::Press(press) => PressScene::new(press, seed, parts).map(Self::Press),
            SceneConfig::Fingertip(sensor) => MeasuredSensor::new(sensor).map(Self::Sensor),
        }
    }

    /// Runs a trial as [`Trials::trial`] does.
    ///
    /// # Errors
    /// The stable name of the failure; outcomes of a failed trial do not count.
    pub fn trial(
        &self,
        trial: u64,
        mut observe: impl FnMut(usize, Outcome),
    ) -> Result<(), &'static str> {
        (**self).trial(trial, &mut observe)
    }
}

/// Scenes of a study's cells.
pub trait Scenes {
    /// Builds the scene of a cell.
    ///
    /// # Errors
    /// A [`ConfigError`] at the field that prevents the scene: a pitch larger than the probe, a formula with a syntax
    /// error, a first contact off the object. Also if no cell has this number.
    fn scene(&self, cell: usize) -> Result<Scene, ConfigError>;

    /// Builds the scene of a cell, and checks that its readings determine an estimate. Traces do not need this check.
    ///
    /// # Errors
    /// Errors of [`Scenes::scene`], and those of [`Trials::estimable`].
    fn estimable_scene(&self, cell: usize) -> Result<Scene, ConfigError>;

    /// Does the same as [`Scenes::estimable_scene`] for a cell that is already parsed; other cells may share `parts`.
    ///
    /// # Errors
    /// Errors of [`Scenes::estimable_scene`].
    fn estimable_scene_of(
        &self,
        number: usize,
        cell: &Cell,
        parts: &Parts,
    ) -> Result<Scene, ConfigError>;

    /// Builds the scene of a cell with the model of another rung.
    ///
    /// # Errors
    /// Errors of [`Scenes::scene`], at `scene.model` if the rung cannot simulate the scene.
    fn with_model(&self, cell: usize, rung: &Rung) -> Result<Scene, ConfigError>;

    /// Measures the error of each rung of a cell's scene; `None` if it has no ladder.
    ///
    /// # Errors
    /// Errors of [`Scenes::estimable_scene`].
    fn ladder(&self, cell: usize) -> Result<Option<Ladder>, ConfigError> {
        self.ladder_of(cell, &self.estimable_scene(cell)?)
    }

    /// Does the same as [`Scenes::ladder`] for a scene that is already built.
    ///
    /// # Errors
    /// Errors of [`Trials::ladder`], with their place in the config.
    fn ladder_of(&self, cell: usize, scene: &Scene) -> Result<Option<Ladder>, ConfigError>;
}

impl Scenes for Study {
    fn scene(&self, cell: usize) -> Result<Scene, ConfigError> {
        let config = self.cell(cell)?.config;
        Scene::new(&config.scene, config.seed).map_err(|error| located(self, cell, error))
    }

    fn estimable_scene(&self, cell: usize) -> Result<Scene, ConfigError> {
        self.estimable_scene_of(cell, &self.cell(cell)?, &Parts::default())
    }

    fn estimable_scene_of(
        &self,
        number: usize,
        cell: &Cell,
        parts: &Parts,
    ) -> Result<Scene, ConfigError> {
        let config = &cell.config;
        let scene = Scene::of(&config.scene, config.seed, parts);
        let is_estimable = |scene: Scene| scene.estimable().map(|()| scene);
        scene
            .and_then(is_estimable)
            .map_err(|error| located(self, number, error))
    }

    fn with_model(&self, cell: usize, rung: &Rung) -> Result<Scene, ConfigError> {
        let config = self.cell(cell)?.config;
        match config.scene.with_model(&rung.model) {
            Some(scene) => {
                Scene::new(&scene, config.seed).map_err(|error| located(self, cell, error))
            }
            None => {
                let message = format!("{} is no model of this kind of scene", rung.name);
                Err(self.error_at(cell, "scene.model", message))
            }
        }
    }

    fn ladder_of(&self, cell: usize, scene: &Scene) -> Result<Option<Ladder>, ConfigError> {
        scene.ladder().map_err(|error| located(self, cell, error))
    }
}

/// Adds the place in the config's text to an error of a plan.
fn located(study: &Study, cell: usize, error: FieldError) -> ConfigError {
    match error.part {
        Some(part) => study.error_in_text(cell, &error.path, part, error.message),
        None => study.error_at(cell, &error.path, error.message),
    }
}
