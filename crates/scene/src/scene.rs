//! Scenes of all kinds, their trials, and the scenes of a study's grid points.

use std::fmt;
use std::ops::{Deref, Range};

use palpate_estimators::map_table;
use palpate_study::config::{Cell, ConfigError, LengthUnit, SceneConfig, Study};
use palpate_study::{FieldError, Quantity, Table, Warning};
use palpate_sweep::{Observation, Record, Trial};

use crate::glide::GlideScene;
use crate::ladder::Ladder;
use crate::measured_sensor::MeasuredSensor;
use crate::press::{PressScene, SharedModels};
use crate::roll::{Arch, RollScene};
use crate::trace::{Trace, TraceError};

/// A scene of any kind that is ready to run its [`Trials`].
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
/// // Without noise, the estimated curvature of the ball is exact: 1/4.
/// let mut estimates = Vec::new();
/// scene.trial(0, |_, outcome| estimates.push(outcome.estimate))?;
/// assert!((estimates[0] - 0.25).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one per cell")]
pub enum Scene {
    /// Probes roll on an object, and the sensor reads their rotations and contacts.
    Roll(RollScene),
    /// Fingers slide over a patch of an object, and the sensor reads their contacts.
    Glide(GlideScene),
    /// A soft sphere with markers under its skin is pressed onto an object.
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

/// Quantities that the scene of a config reports, as in [`Trials::quantities`]. The scene is not built.
pub fn quantities_of(config: &SceneConfig) -> &'static [Quantity] {
    match config {
        SceneConfig::Roll(roll) => crate::roll::quantities_of(roll.principal_curvatures),
        SceneConfig::Glide(glide) => GlideScene::quantities_of(glide),
        SceneConfig::Press(press) => PressScene::quantities_of(press),
        SceneConfig::Fingertip(sensor) => MeasuredSensor::quantities_of(&sensor.probe),
    }
}

/// Empty table for the maps of a scene. The scene is not built.
///
/// # Errors
/// A text that states the reason if scenes of this kind have no maps.
pub fn map_table_of(config: &SceneConfig, unit: LengthUnit) -> Result<Table, &'static str> {
    match config {
        SceneConfig::Glide(_) => Ok(map_table(unit, true)),
        SceneConfig::Press(_) => Ok(PressScene::profile_table(unit)),
        SceneConfig::Roll(_) => Err("a roll has no map; \"cells\" and \"trace\" are possible"),
        SceneConfig::Fingertip(_) => {
            Err("a fingertip that touches nothing has no map; \"cells\" is possible")
        }
    }
}

impl Scene {
    /// Builds the scene of a config. The lengths in the config are in `unit`. `seed` is the seed of the scene's random
    /// numbers. Several scenes may share `models`.
    ///
    /// # Errors
    /// [`FieldError`] with the path of the invalid field.
    pub fn new(
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

    /// Runs a trial, like [`Trials::trial`].
    ///
    /// # Errors
    /// The name of the failure, which stays the same in all versions. Outcomes of a failed trial must be ignored.
    pub fn trial(
        &self,
        trial: u64,
        mut observe: impl FnMut(usize, Observation),
    ) -> Result<(), &'static str> {
        (**self).trial(trial, &mut observe)
    }
}

/// Builds the scenes of a study's grid points (cells).
pub trait Scenes {
    /// Builds the scene of the grid point with the number `cell`.
    ///
    /// # Errors
    /// [`ConfigError`] if there is no grid point with this number, or if the scene is impossible. In the second case,
    /// the error is at the field that causes it: for example, a pitch larger than the probe, a formula with a syntax
    /// error, or a first contact that is not on the object.
    fn scene(&self, cell: usize) -> Result<Scene, ConfigError>;

    /// Builds the scene of the grid point with the number `cell`, and checks that its readings determine an estimate.
    /// Use [`Scenes::scene`] if no estimate is needed.
    ///
    /// # Errors
    /// The errors of [`Scenes::scene`] and [`Trials::estimable`].
    fn estimable_scene(&self, cell: usize) -> Result<Scene, ConfigError>;

    /// Builds and checks a scene like [`Scenes::estimable_scene`], for a grid point that is already parsed. Several
    /// grid points may share `models`.
    ///
    /// # Errors
    /// The errors of [`Scenes::estimable_scene`].
    fn estimable_scene_of(
        &self,
        number: usize,
        cell: &Cell,
        models: &SharedModels,
    ) -> Result<Scene, ConfigError>;

    /// Measures the errors of the models that can compute the scene of the grid point with the number `cell`; `None` if
    /// there is only one model.
    ///
    /// # Errors
    /// The errors of [`Scenes::estimable_scene`].
    fn ladder(&self, cell: usize) -> Result<Option<Ladder>, ConfigError>;
}

impl Scenes for Study {
    fn scene(&self, cell: usize) -> Result<Scene, ConfigError> {
        let config = self.cell(cell)?.config;
        let models = SharedModels::default();
        Scene::new(&config.scene, config.length_unit, config.seed, &models)
            .map_err(|error| self.error_at(cell, error))
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
        let scene = Scene::new(&config.scene, config.length_unit, config.seed, models);
        let is_estimable = |scene: Scene| scene.estimable().map(|()| scene);
        scene
            .and_then(is_estimable)
            .map_err(|error| self.error_at(number, error))
    }

    fn ladder(&self, cell: usize) -> Result<Option<Ladder>, ConfigError> {
        let ladder = self.estimable_scene(cell)?.ladder();
        ladder.map_err(|error| self.error_at(cell, error))
    }
}

/// Function that receives the outcomes of a trial, each with the index of its quantity.
pub(crate) type Observer<'a> = &'a mut (dyn FnMut(usize, Observation) + 'a);

/// Trials of a scene. A trial simulates readings and estimates the true values from them.
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
/// // Nothing is random, so that one trial is enough.
/// assert_eq!(scene.trials(1000), 1);
/// let last = scene.quantities().len() - 1;
/// assert_eq!(scene.quantities()[last].name, "arc_length");
/// assert!((scene.truth(last).ok_or("the same everywhere")? - 0.08).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Trials {
    /// Quantities that a trial reports. Their order defines the indices in [`Trials::trial`].
    fn quantities(&self) -> &'static [Quantity];

    /// Whether trials have different outcomes, because something in the scene is random.
    fn is_random(&self) -> bool;

    /// Number of trials to run: `wanted`, or 1 if nothing is random.
    fn trials(&self, wanted: u64) -> u64 {
        if self.is_random() { wanted } else { 1 }
    }

    /// Checks that readings without noise determine the estimated quantities of the scene.
    ///
    /// # Errors
    /// [`FieldError`] if the readings do not determine the quantities. The error is at the field that causes it: for
    /// example, fewer than two probes or only parallel rolls, too few contacts or contacts on one line, or too few
    /// markers.
    fn estimable(&self) -> Result<(), FieldError> {
        Ok(())
    }

    /// Runs trial number `trial` and reports its outcomes, each with the index of its quantity. Each quantity is
    /// reported once or, for a patch, once at every point.
    ///
    /// # Errors
    /// The name of the failure, which stays the same in all versions. Outcomes of a failed trial must be ignored.
    fn trial(&self, trial: u64, observe: Observer<'_>) -> Result<(), &'static str>;

    /// Runs a trial like [`Trials::trial`]. In addition, it returns the names of the warnings about the estimate. The
    /// warnings state how the readings contradict the estimator's model.
    ///
    /// # Errors
    /// The errors of [`Trials::trial`].
    fn trial_with_warnings(
        &self,
        trial: u64,
        observe: Observer<'_>,
    ) -> Result<Vec<&'static str>, &'static str> {
        self.trial(trial, observe).map(|()| Vec::new())
    }

    /// True value of the quantity with the index `quantity`; `None` if this value is not the same at all points of the
    /// scene, for example at all grid points of a patch.
    fn truth(&self, quantity: usize) -> Option<f64>;

    /// Name of the true shape class of the patch: the class of more than half of its points. `None` if there is no such
    /// class, and for scenes without a patch.
    fn true_class(&self) -> Option<&'static str> {
        None
    }

    /// Cramér–Rao bound on the standard deviation of an estimate. `_quantity` is the index of the quantity. Only
    /// presses with noise have this bound; for other scenes, the result is `None`.
    fn std_bound(&self, _quantity: usize) -> Option<f64> {
        None
    }

    /// Messages about the scene: the models that it needs, each with the reason, and warnings.
    fn needs(&self) -> Vec<Need>;

    /// Measures the errors of the models that can compute the true values; `None` if there is only one model.
    ///
    /// # Errors
    /// [`FieldError`] if the model cannot simulate the scene.
    fn ladder(&self) -> Result<Option<Ladder>, FieldError> {
        Ok(None)
    }

    /// Records one simulation of the scene. It has the noise of the trial with the given number; it has no noise if the
    /// number is `None`.
    ///
    /// # Errors
    /// [`TraceError`] if the scene has no contact, or if its simulation ends early.
    fn trace(&self, _trial: Option<u64>, _unit: LengthUnit) -> Result<Trace, TraceError> {
        Err(TraceError::Untouched)
    }

    /// Adds the map of a trial to a table from [`map_table_of`]. The rows begin with the number of the grid point
    /// (`cell`).
    ///
    /// # Errors
    /// The name of the failure, which stays the same in all versions. The table then contains no estimates for this
    /// grid point.
    fn map(&self, _cell: usize, _trial: u64, _table: &mut Table) -> Result<(), &'static str> {
        Ok(())
    }
}

/// Message about a scene. `palpate check` prints its `Display` text.
#[derive(Clone, Debug, PartialEq)]
pub enum Need {
    /// A model that the scene needs, and the reason for it.
    Model(String),
    /// A warning about the scene.
    Warning(Warning),
}

impl fmt::Display for Need {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(model) => f.write_str(model),
            Self::Warning(warning) => warning.fmt(f),
        }
    }
}

/// The texts that are not `None`, with `separator` between them; `None` if there are none.
pub(crate) fn joined<T: Into<String>>(
    texts: impl IntoIterator<Item = Option<T>>,
    separator: &str,
) -> Option<String> {
    let texts = texts.into_iter().flatten().map(Into::into);
    texts.reduce(|all, text| all + separator + &text)
}

/// A scene in the form that the sweep runner needs to run its trials.
#[derive(Debug)]
pub struct SceneTrial {
    /// The scene whose trials are run.
    pub scene: Scene,
    /// Processor's vector instructions with which batches of trials run. They do not change the results of the trials.
    pub arch: Arch,
}

impl Trial for SceneTrial {
    fn quantities(&self) -> usize {
        self.scene.quantities().len()
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        self.scene
            .trial(trial, |quantity, one| record.observe(quantity, one))
    }

    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        match &self.scene {
            Scene::Roll(roll) => roll.side_by_side(self.arch, trials, |observed| {
                record.observe_together(observed)
            }),
            _ => 0,
        }
    }

    fn is_random(&self) -> bool {
        self.scene.is_random()
    }
}
