//! Chooses the number of trials and the model for cells of a study.

use palpate_scene::{Arch, Scene, SceneTrial, Scenes, SharedModels, TOLERANCES};
use palpate_study::config::{
    self, ConfigError, GlideModelConfig, GlideSensorConfig, ModelConfig, PressModelConfig,
    PressSensorConfig, RollModelConfig, RollSensorConfig, SceneConfig, Study, StudyConfig,
};
use palpate_study::{FieldError, Quantity, Unit};
use palpate_sweep::{Clock, Runner};

use crate::planner::{self, Goal, Pass, PassQuantity, PassValue, Plan, PlanError, Plannable};

/// Chooses the number of trials for cells of a study. Also chooses the tolerance of the model `auto`, if all cells use
/// it. The returned study states these choices, so it can be run again without planning.
///
/// ```
/// use std::time::{Duration, Instant};
/// use palpate::{Goal, RunOptions, Runner};
///
/// let text = r#"
/// name = "a-ball"
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// noise = { angular_velocity = { kind = "uniform", fraction = 0.05 } }
/// "#;
/// let study = palpate::parse("a-ball.toml", text)?;
/// let runner = Runner::new(&RunOptions::default())?;
/// let goal = Goal { target_error: Some(0.05), budget: None };
/// // Without a budget, the clock has no effect.
/// let start = Instant::now();
/// let (study, plan) = palpate::plan(&study, &[0], &goal, &runner, &|| start.elapsed())?;
/// // Gaussian errors need 1/(2 · 0.05²) = 200 trials, and the margin adds to that.
/// assert!((150..400).contains(&study.config.trials));
/// assert_eq!(plan.trials().map(u64::from), Some(study.config.trials));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PlanError`]. A cell in this error is an index into `numbers`. If the study sweeps the number of trials, the error
/// is [`PlanError::SetUp`].
pub fn plan(
    study: &Study,
    numbers: &[usize],
    goal: &Goal,
    runner: &Runner,
    clock: &Clock<'_>,
) -> Result<(Study, Plan), PlanError<ConfigError>> {
    if study.paths.iter().any(|path| path == "trials") {
        let message = "is swept, so that neither a budget nor a target error can choose it";
        return Err(PlanError::SetUp(
            study.error_at(0, FieldError::at("trials", message)),
        ));
    }
    let cells = Chosen::new(study.clone(), numbers.to_vec());
    let (planned, plan) = planner::plan(&cells, goal, runner, clock)?;
    let mut study = planned.study;
    if let Some(trials) = plan.trials() {
        let chosen = study.override_numbers(None, Some(trials.get()));
        chosen.map_err(PlanError::SetUp)?;
    }
    Ok((study, plan))
}

/// Cells of a study. A plan chooses the number of trials and the model for these cells.
struct Chosen {
    study: Study,
    /// Numbers of the chosen cells in the study.
    numbers: Vec<usize>,
    /// Whether all cells have the model `auto` with the same tolerance.
    is_auto: bool,
}

impl Chosen {
    fn new(study: Study, numbers: Vec<usize>) -> Self {
        let swept = |path: &String| {
            ["scene", "scene.kind"].contains(&path.as_str()) || path.starts_with("scene.model")
        };
        let is_auto = with_tolerance(&study.config.scene, 0.1).is_some();
        Self {
            is_auto: is_auto && !study.paths.iter().any(swept),
            study,
            numbers,
        }
    }
}

impl Plannable for Chosen {
    type Trial = SceneTrial;
    type Error = ConfigError;

    fn cells(&self) -> usize {
        self.numbers.len()
    }

    fn set_up(&self, cell: usize) -> Result<SceneTrial, ConfigError> {
        let scene = self.study.estimable_scene(self.numbers[cell]);
        let arch = Arch::new();
        scene.map(|scene| SceneTrial { scene, arch })
    }

    fn quantity(trial: &SceneTrial, quantity: usize) -> &'static str {
        trial.scene.quantities()[quantity].name
    }

    fn tolerances(&self) -> &[f64] {
        match self.is_auto {
            true => &TOLERANCES,
            false => &[],
        }
    }

    fn pass(&self, cell: usize, trial: &SceneTrial, tolerance: f64) -> Option<Pass> {
        let cell = self.study.cell(self.numbers[cell]).ok()?;
        pass(&cell.config, trial.scene.quantities(), tolerance)
    }

    /// Copy of the chosen cells in which the model `auto` has this `tolerance`. If these are all cells of the study,
    /// and `auto` chooses the same model in each of them, the chosen model replaces `auto`.
    fn with_tolerance(&self, tolerance: Option<f64>) -> Result<Self, ConfigError> {
        let parsed = |config: &StudyConfig| config::parse("run.toml", &config::to_toml(config));
        let mut config = self.study.config.clone();
        if let Some(scene) = tolerance.and_then(|one| with_tolerance(&config.scene, one)) {
            config.scene = scene;
        }
        let mut study = parsed(&config)?;
        let is_whole = self.numbers.len() == self.study.cell_count();
        if is_whole
            && self.is_auto
            && let Some(rung) = common_rung(&study)?
            && let Some(scene) = config.scene.with_model(&rung)
        {
            config.scene = scene;
            study = parsed(&config)?;
        }
        Ok(Self {
            study,
            numbers: self.numbers.clone(),
            is_auto: self.is_auto,
        })
    }
}

/// The model that `auto` chooses in all cells of a study; `None` if it chooses different models.
fn common_rung(study: &Study) -> Result<Option<ModelConfig>, ConfigError> {
    let mut common = None;
    for cell in 0..study.cell_count() {
        let taken = study.ladder(cell)?;
        let taken = taken.map(|ladder| ladder.taken().model.clone());
        match (&common, taken) {
            (None, Some(taken)) => common = Some(taken),
            (Some(known), Some(taken)) if *known == taken => {}
            (_, _) => return Ok(None),
        }
    }
    Ok(common)
}

/// Estimates and true values of a trial without noise, computed with this tolerance of the model `auto`. `in_cell`
/// lists the quantities of the cell. Returns `None` if the scene cannot be set up or the trial fails.
fn pass(config: &StudyConfig, in_cell: &[Quantity], tolerance: f64) -> Option<Pass> {
    let set_up = |scene: &SceneConfig| {
        let models = SharedModels::default();
        Scene::new(scene, config.length_unit, config.seed, &models).ok()
    };
    let mut scene = with_tolerance(&config.scene, tolerance)?;
    if matches!(scene, SceneConfig::Roll(_)) {
        // Choose the model for the scene with its noise. Without noise, `auto` could choose a model that holds only for
        // a probe on a line of symmetry, but noise moves the probe off this line.
        let ladder = set_up(&scene)?.ladder().ok()??;
        scene = scene.with_model(&ladder.taken().model)?;
    }
    let scene = set_up(&with_ideal_sensor(&scene))?;
    let quantities = scene.quantities();
    let mut values = Vec::new();
    let mut truths = vec![0.0_f64; quantities.len()];
    scene
        .trial(0, |quantity, outcome| {
            // A shape class and an undetermined axis are not magnitudes that an error of the contact model can shift,
            // so both quantities are left out.
            if ![Quantity::CLASS, Quantity::AXIS_UNDETERMINED].contains(&quantities[quantity]) {
                truths[quantity] = truths[quantity].max(outcome.truth.abs());
                values.push(PassValue {
                    quantity,
                    estimate: outcome.estimate,
                    truth: outcome.truth,
                });
            }
        })
        .ok()?;
    // The shift of an estimate by the contact model is divided by the largest true value of its quantity. If all true
    // values of the quantity are 0, it is divided by the largest true value of all quantities with the same unit.
    let of_unit = |place: usize| {
        let alike = (0..truths.len()).filter(|&one| quantities[one].unit == quantities[place].unit);
        alike.map(|one| truths[one]).fold(0.0, f64::max)
    };
    let quantities = (0..truths.len()).map(|place| PassQuantity {
        scale: match truths[place] {
            // An angle has no typical size, so its errors are relative to 1 rad.
            _ if quantities[place].unit == Unit::Degree => 1_f64.to_degrees(),
            0.0 => of_unit(place),
            truth => truth,
        },
        in_cell: in_cell
            .iter()
            .position(|one| one.name == quantities[place].name),
    });
    Some(Pass {
        quantities: quantities.collect(),
        values,
    })
}

/// Copy of a scene without noise and with an ideal sensor. Its set-up is fast.
pub(crate) fn with_ideal_sensor(scene: &SceneConfig) -> SceneConfig {
    let mut scene = scene.clone();
    match &mut scene {
        SceneConfig::Roll(roll) => {
            roll.noise = Default::default();
            roll.sensor = RollSensorConfig::default();
        }
        SceneConfig::Glide(glide) => {
            glide.noise = Default::default();
            if matches!(glide.sensor, GlideSensorConfig::Pads { .. }) {
                glide.sensor = GlideSensorConfig::default();
            }
        }
        SceneConfig::Press(press) => {
            press.noise = Default::default();
            if press.sensor.camera().is_some() {
                press.sensor = PressSensorConfig::default();
            }
        }
        SceneConfig::Fingertip(_) => {}
    }
    scene
}

/// Copy of a scene with this tolerance for the model `auto`; `None` if the scene has another model or no model.
fn with_tolerance(scene: &SceneConfig, tolerance: f64) -> Option<SceneConfig> {
    let mut scene = scene.clone();
    let of_auto = match &mut scene {
        SceneConfig::Roll(roll) => match &mut roll.model {
            RollModelConfig::Auto { tolerance, .. } => Some(tolerance),
            _ => None,
        },
        SceneConfig::Glide(glide) => match &mut glide.model {
            GlideModelConfig::Auto { tolerance } => Some(tolerance),
            _ => None,
        },
        SceneConfig::Press(press) => match &mut press.model {
            PressModelConfig::Auto { tolerance, .. } => Some(tolerance),
            _ => None,
        },
        SceneConfig::Fingertip(_) => None,
    };
    *of_auto? = tolerance;
    Some(scene)
}
