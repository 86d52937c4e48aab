//! Scenes of any kind, their trials, and the scenes of a study's cells.

use std::fmt;
use std::ops::Deref;

use palpate_estimators::map_table;
use palpate_study::config::{Cell, ConfigError, LengthUnit, SceneConfig, Study};
use palpate_study::{FieldError, MapTable, Quantity, Warning};
use palpate_sweep::Observation;

use crate::cache::SharedModels;
use crate::glide::{GLIDE_QUANTITIES, GlideScene};
use crate::ladder::{Ladder, Rung};
use crate::measured_sensor::MeasuredSensor;
use crate::press::PressScene;
use crate::roll::{ROLL_QUANTITIES, RollScene};
use crate::trace::{Trace, TraceError};

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
        SceneConfig::Roll(_) => &ROLL_QUANTITIES,
        SceneConfig::Glide(_) => &GLIDE_QUANTITIES,
        SceneConfig::Press(press) => PressScene::quantities_of(press),
        SceneConfig::Fingertip(sensor) => MeasuredSensor::quantities_of(&sensor.probe),
    }
}

/// Empty table for the maps of a config's scene, as [`Trials::map_table`] returns it, without building the scene.
pub fn map_table_of(config: &SceneConfig, unit: LengthUnit) -> Option<MapTable> {
    match config {
        SceneConfig::Glide(_) => Some(map_table(unit, true)),
        SceneConfig::Press(_) => Some(PressScene::profile_table(unit)),
        SceneConfig::Roll(_) | SceneConfig::Fingertip(_) => None,
    }
}

impl Scene {
    /// Builds the scene of a config with lengths in this unit; `seed` seeds its random numbers.
    ///
    /// # Errors
    /// [`FieldError`] with the path of the invalid field.
    pub fn new(config: &SceneConfig, unit: LengthUnit, seed: u64) -> Result<Self, FieldError> {
        Self::of(config, unit, seed, &SharedModels::default())
    }

    /// Does the same as [`Scene::new`]; other scenes may share `models`.
    ///
    /// # Errors
    /// Errors of [`Scene::new`].
    pub fn of(
        config: &SceneConfig,
        unit: LengthUnit,
        seed: u64,
        models: &SharedModels,
    ) -> Result<Self, FieldError> {
        match config {
            SceneConfig::Roll(roll) => RollScene::new(roll, seed).map(Self::Roll),
            SceneConfig::Glide(glide) => GlideScene::new(glide, seed).map(Self::Glide),
            SceneConfig::Press(press) => {
                PressScene::new(press, unit, seed, models).map(Self::Press)
            }
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
        mut observe: impl FnMut(usize, Observation),
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

    /// Does the same as [`Scenes::estimable_scene`] for a cell that is already parsed; other cells may share `models`.
    ///
    /// # Errors
    /// Errors of [`Scenes::estimable_scene`].
    fn estimable_scene_of(
        &self,
        number: usize,
        cell: &Cell,
        models: &SharedModels,
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
        Scene::new(&config.scene, config.length_unit, config.seed)
            .map_err(|error| located(self, cell, error))
    }

    fn estimable_scene(&self, cell: usize) -> Result<Scene, ConfigError> {
        self.estimable_scene_of(cell, &self.cell(cell)?, &SharedModels::default())
    }

    fn estimable_scene_of(
        &self,
        number: usize,
        cell: &Cell,
        models: &SharedModels,
    ) -> Result<Scene, ConfigError> {
        let config = &cell.config;
        let scene = Scene::of(&config.scene, config.length_unit, config.seed, models);
        let is_estimable = |scene: Scene| scene.estimable().map(|()| scene);
        scene
            .and_then(is_estimable)
            .map_err(|error| located(self, number, error))
    }

    fn with_model(&self, cell: usize, rung: &Rung) -> Result<Scene, ConfigError> {
        let config = self.cell(cell)?.config;
        let Some(scene) = config.scene.with_model(&rung.model) else {
            let message = format!("{} is not a model of this kind of scene", rung.name);
            return Err(self.error_at(cell, "scene.model", message));
        };
        Scene::new(&scene, config.length_unit, config.seed)
            .map_err(|error| located(self, cell, error))
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

/// Trials of a scene: from true values to readings to estimates.
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
/// // Nothing is random: all trials are the same.
/// assert_eq!(scene.trials(1000), 1);
/// let last = scene.quantities().len() - 1;
/// assert_eq!(scene.quantities()[last].name, "arc_length");
/// assert!((scene.truth(last).ok_or("the same everywhere")? - 0.08).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Trials {
    /// Quantities that a trial reports, in the order of the indices of [`Trials::trial`].
    fn quantities(&self) -> &'static [Quantity];

    /// Whether trials differ.
    fn is_random(&self) -> bool;

    /// How many trials make sense: `wanted`, or one if nothing is random.
    fn trials(&self, wanted: u64) -> u64 {
        if self.is_random() { wanted } else { 1 }
    }

    /// Checks that readings without noise determine the quantities.
    ///
    /// # Errors
    /// [`FieldError`] at the field that prevents it: fewer than two probes, or all parallel; too few contacts, or all
    /// on a line; too few markers.
    fn estimable(&self) -> Result<(), FieldError> {
        Ok(())
    }

    /// Runs trial number `trial` and reports outcomes, each with the index of its quantity: one of each quantity, or,
    /// for a patch, one of each quantity at every point.
    ///
    /// # Errors
    /// The stable name of the failure; outcomes of a failed trial do not count.
    fn trial(
        &self,
        trial: u64,
        observe: &mut dyn FnMut(usize, Observation),
    ) -> Result<(), &'static str>;

    /// Runs a trial as [`Trials::trial`] does, and returns the names of the warnings of its estimate: the readings
    /// contradict the estimator's model.
    ///
    /// # Errors
    /// As [`Trials::trial`].
    fn trial_with_warnings(
        &self,
        trial: u64,
        observe: &mut dyn FnMut(usize, Observation),
    ) -> Result<Vec<&'static str>, &'static str> {
        self.trial(trial, observe).map(|()| Vec::new())
    }

    /// The true value of the quantity with this index, if it is the same everywhere.
    fn truth(&self, quantity: usize) -> Option<f64>;

    /// Name of the true shape class at more than half of the points of a patch; `None` if there is no such class, and
    /// for other scenes.
    fn true_class(&self) -> Option<&'static str> {
        None
    }

    /// The Cramér–Rao bound on the standard deviation of an estimate of the quantity with this index. It is available
    /// for presses with noise.
    fn std_bound(&self, _quantity: usize) -> Option<f64> {
        None
    }

    /// The models that the scene needs with the reasons, and warnings.
    fn needs(&self) -> Vec<Need>;

    /// Measures the errors of the models that can compute the true values; `None` if there is no choice.
    ///
    /// # Errors
    /// [`FieldError`] if the model cannot simulate the scene.
    fn ladder(&self) -> Result<Option<Ladder>, FieldError> {
        Ok(None)
    }

    /// Records one pass: in trial number `trial`, or without noise if it is `None`.
    ///
    /// # Errors
    /// [`TraceError`] if there is no pass, or if it ends early.
    fn trace(&self, _trial: Option<u64>, _unit: LengthUnit) -> Result<Trace, TraceError> {
        Err(TraceError::Untouched)
    }

    /// Empty table for the maps of scenes of this kind.
    ///
    /// # Errors
    /// Reason why there is no map, in words.
    fn map_table(&self, unit: LengthUnit) -> Result<MapTable, &'static str>;

    /// Adds the map of trial number `trial` to a table made with [`Trials::map_table`], in rows that begin with the number
    /// of their cell.
    ///
    /// # Errors
    /// The stable name of the failure; the map then lacks estimates of the cell.
    fn map(&self, _cell: usize, _trial: u64, _table: &mut MapTable) -> Result<(), &'static str> {
        Ok(())
    }
}

/// Message about a scene; `palpate check` prints its `Display` text.
#[derive(Clone, Debug, PartialEq)]
pub enum Need {
    /// A model that the scene needs, and why.
    Model(String),
    /// A warning.
    Warning(Warning),
}

impl From<String> for Need {
    fn from(model: String) -> Self {
        Self::Model(model)
    }
}

impl From<Warning> for Need {
    fn from(warning: Warning) -> Self {
        Self::Warning(warning)
    }
}

impl fmt::Display for Need {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(model) => f.write_str(model),
            Self::Warning(warning) => warning.fmt(f),
        }
    }
}
