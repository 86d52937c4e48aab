//! Random scenes, the models that `auto` chooses for them, and the computations whose costs are compared.

use std::hint::black_box;

use anyhow::{Context, Result, anyhow, bail};
use palpate_scene::{GlideScene, RollScene, Rung, Scenes};
use palpate_study::config::{self, ModelConfig, PressConfig, PressModelConfig, SceneConfig, Study};

use super::auto_scenes::{Kind, config_text};
use super::competing_models::{CompetingModel, CompetingModels, body, curvature, markers};
use crate::timing::Evaluation;

/// Number of random scenes of each kind (roll, glide, press).
pub const SCENES: u64 = 50;
/// Largest allowed ratio of the chosen model's cost to the cost of the cheapest model within the tolerance.
pub(super) const MAX_COST_RATIO: f64 = 2.0;
/// If a roll model evaluates the contact equations more than this number of times as often as the chosen model, it
/// counts as more expensive. Its instructions are then not counted.
const MAX_EVALUATION_RATIO: usize = 3;

/// A random scene with the model that `auto` chose, and the models that it could have chosen.
#[derive(Debug)]
pub struct AutoChoice {
    /// Kind of the scene.
    pub kind: Kind,
    /// Number of the scene among the scenes of its kind.
    pub number: u64,
    study: Study,
    /// All models for the scene, with their errors relative to an independent reference.
    pub models: Vec<CompetingModel>,
    /// Index in `models` of the model that `auto` chose.
    pub(super) taken: usize,
    /// Name of the reference method, whose results are used as true values.
    pub truth: &'static str,
    /// Tolerance of the setting `auto` in this scene.
    pub tolerance: f64,
}

impl AutoChoice {
    /// The choice of `auto` on scene `number` of this kind.
    ///
    /// # Errors
    /// An error if the scene cannot be set up, or its model is not `auto`.
    pub fn new(kind: Kind, number: u64) -> Result<Self> {
        let name = format!("{}-{number}.toml", kind.name());
        let study = config::parse(&name, &config_text(kind, number))?;
        let ladder = study
            .ladder(0)?
            .with_context(|| format!("{name} has no ladder"))?;
        let tolerance = ladder
            .tolerance
            .with_context(|| format!("{name} has no tolerance"))?;
        let CompetingModels { all, taken, truth } =
            CompetingModels::new(&study, &ladder).with_context(|| name.clone())?;
        Ok(Self {
            kind,
            number,
            study,
            models: all,
            taken,
            truth,
            tolerance,
        })
    }

    /// The model that `auto` chose.
    pub fn taken(&self) -> &Rung {
        &self.models[self.taken].rung
    }

    /// Whether the error of the chosen model is within the tolerance of `auto`.
    pub fn errs_within(&self) -> bool {
        self.is_adequate(self.taken)
    }

    /// Number of models, besides the chosen one, whose error is within the tolerance.
    pub fn competitors(&self) -> usize {
        let others = (0..self.models.len()).filter(|place| *place != self.taken);
        others.filter(|place| self.is_adequate(*place)).count()
    }

    /// Whether the reference method differs from the method of the chosen model.
    pub fn has_independent_truth(&self) -> bool {
        let method = |name: &str| name.split([' ', ',', ':']).next().map(str::to_owned);
        method(&self.taken().name) != method(self.truth)
    }

    /// Whether the chosen model is cheap enough, according to rules that need no instruction counts. A roll must
    /// evaluate the contact equations at most twice as often as with any other model within the tolerance. For a glide,
    /// the closed form must be chosen if it is within the tolerance. For a press, the error of every cheaper model must
    /// be above the tolerance.
    pub fn seems_cheap(&self) -> bool {
        let evaluations = |place: usize| self.models[place].evaluations.unwrap_or(0) as f64;
        let taken = evaluations(self.taken);
        let mut adequate = (0..self.models.len()).filter(|place| self.is_adequate(*place));
        match self.kind {
            Kind::Roll => adequate.all(|place| taken <= MAX_COST_RATIO * evaluations(place)),
            Kind::Glide => self.taken == 0 || !self.is_adequate(0),
            // Hertz contact (model 0) and the half-space (model 1) cost the same. Therefore both count as model 1.
            Kind::Press => adequate.all(|place| place.max(1) >= self.taken),
        }
    }

    pub(super) fn is_adequate(&self, place: usize) -> bool {
        matches!(self.models[place].rung.accuracy, palpate::Accuracy::Error(error) if error <= self.tolerance)
    }

    /// Indices in `models` of the models whose instructions are counted. These are the chosen model and all models that
    /// meet the tolerance and may be cheaper.
    pub(super) fn counted(&self) -> impl Iterator<Item = usize> {
        let taken = self.models[self.taken].evaluations;
        (0..self.models.len()).filter(move |&place| {
            let evaluations = self.models[place].evaluations;
            let is_dearer = evaluations > taken.map(|taken| MAX_EVALUATION_RATIO * taken);
            place == self.taken || self.is_adequate(place) && !is_dearer
        })
    }

    /// A computation for each model that [`Self::counted`] selects. The instructions of these computations are counted.
    pub(super) fn evaluations(&self) -> Result<Vec<Evaluation>> {
        self.counted().map(|place| self.evaluation(place)).collect()
    }

    /// The computation, without noise, of the scene's contacts or displacements with the model `models[place]`.
    fn evaluation(&self, place: usize) -> Result<Evaluation> {
        let rung = &self.models[place].rung;
        let mut run = truth(&self.study, rung)?;
        let name = format!("{} {}: {}", self.kind.name(), self.number, rung.name);
        run().with_context(|| name.clone())?;
        Ok(Evaluation::new(name, run))
    }
}

/// A repeatable computation. It returns the number of contacts or markers that it has computed.
type Computation = Box<dyn FnMut() -> Result<usize>>;

/// Returns a computation that simulates the first grid point of the study with the model `rung`, without noise. It
/// computes the contacts of a roll or a glide, or the marker displacements of a press. The set-up of the scene is not
/// part of the computation.
fn truth(study: &Study, rung: &Rung) -> Result<Computation> {
    let scene = &study.config.scene;
    match (scene.with_model(&rung.model), &rung.model) {
        (Some(SceneConfig::Roll(config)), _) => {
            let scene = RollScene::new(&config, study.config.seed);
            Ok(rolls(scene.map_err(|error| anyhow!("{}", error.message))?))
        }
        (Some(SceneConfig::Glide(config)), _) => {
            let glider =
                GlideScene::glider(&config).map_err(|error| anyhow!("{}", error.message))?;
            Ok(Box::new(move || {
                match GlideScene::follow(&glider, &config) {
                    Ok(touches) => Ok(touches.len()),
                    Err(error) => bail!("{}: {}", error.path, error.message),
                }
            }))
        }
        (Some(SceneConfig::Press(config)), ModelConfig::Press(model)) => press(&config, model),
        _ => bail!("{} is not a model of a contact", rung.name),
    }
}

fn rolls(scene: RollScene) -> Computation {
    let rolls = scene.noiseless();
    Box::new(move || {
        for motions in &rolls {
            black_box(scene.roller.shift(motions)?);
        }
        Ok(rolls.len())
    })
}

fn press(config: &PressConfig, model: &PressModelConfig) -> Result<Computation> {
    let (body, markers) = (body(config, model)?, markers(config)?);
    let object_curvature = curvature(config)?;
    let indentation = config.motion.indentation;
    Ok(Box::new(move || {
        let contact = markers
            .skin()
            .contact(&body, object_curvature, indentation)?;
        Ok(black_box(markers.displacements(&contact, [0.0; 2])).len())
    }))
}
