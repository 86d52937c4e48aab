//! Random scenes with the models that `auto` chooses, and the computations whose costs are compared.

use std::hint::black_box;

use anyhow::{Context, Result, anyhow, bail};
use palpate_scene::{GlideScene, Rung, Scene, Scenes};
use palpate_study::config::{self, ModelConfig, PressConfig, PressModelConfig, SceneConfig, Study};

use super::auto_scenes::{Kind, config_text};
use super::competing_models::{CompetingModel, CompetingModels, body, curvature, markers};
use crate::timing::Evaluation;

/// Number of scenes of each kind.
pub const SCENES: u64 = 50;
/// Largest ratio of the cost of the chosen model to that of the cheapest adequate model.
pub(super) const MAX_COST_RATIO: f64 = 2.0;
/// A roll with this many times the evaluations of the contact equations costs more for certain.
const MAX_EVALUATION_RATIO: usize = 3;

/// A random scene with the model that `auto` chose, and the models that it could have chosen.
#[derive(Debug)]
pub struct AutoChoice {
    /// Kind of the scene.
    pub kind: Kind,
    /// Number of the scene among those of its kind.
    pub number: u64,
    study: Study,
    /// All models for the scene, with their errors against an independent computation.
    pub models: Vec<CompetingModel>,
    /// Index in `models` of the model that `auto` chose.
    pub(super) taken: usize,
    /// Name of the reference for the errors.
    pub truth: &'static str,
    /// Tolerance of `auto`.
    pub tolerance: f64,
}

impl AutoChoice {
    /// The choice on the scene of a kind with this number.
    ///
    /// # Errors
    /// If the scene cannot be set up, or its model is not `auto`.
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

    /// Whether the chosen model errs by at most the tolerance.
    pub fn errs_within(&self) -> bool {
        self.is_adequate(self.taken)
    }

    /// Number of other models within the tolerance.
    pub fn competitors(&self) -> usize {
        let others = (0..self.models.len()).filter(|place| *place != self.taken);
        others.filter(|place| self.is_adequate(*place)).count()
    }

    /// Whether the reference is another method than the chosen model.
    pub fn has_independent_truth(&self) -> bool {
        let method = |name: &str| name.split([' ', ',', ':']).next().map(str::to_owned);
        method(&self.taken().name) != method(self.truth)
    }

    /// Whether the chosen model is cheap enough, as far as this can be checked without counting instructions: a roll
    /// evaluates the contact equations at most twice as often as any other adequate model. For glides and presses no earlier
    /// method of the ladder is adequate.
    pub fn seems_cheap(&self) -> bool {
        let evaluations = |place: usize| self.models[place].evaluations.unwrap_or(0) as f64;
        let taken = evaluations(self.taken);
        let mut adequate = (0..self.models.len()).filter(|place| self.is_adequate(*place));
        match self.kind {
            Kind::Roll => adequate.all(|place| taken <= MAX_COST_RATIO * evaluations(place)),
            Kind::Glide => self.taken == 0 || !self.is_adequate(0),
            // Hertz contact and the half-space cost the same.
            Kind::Press => adequate.all(|place| place.max(1) >= self.taken),
        }
    }

    pub(super) fn is_adequate(&self, place: usize) -> bool {
        matches!(self.models[place].rung.accuracy, palpate::Accuracy::Error(error) if error <= self.tolerance)
    }

    /// Indices of the models whose instructions are counted: the chosen one, and the adequate ones that may be cheaper.
    pub(super) fn counted(&self) -> impl Iterator<Item = usize> {
        let taken = self.models[self.taken].evaluations;
        (0..self.models.len()).filter(move |&place| {
            let evaluations = self.models[place].evaluations;
            let is_dearer = evaluations > taken.map(|taken| MAX_EVALUATION_RATIO * taken);
            place == self.taken || self.is_adequate(place) && !is_dearer
        })
    }

    /// An evaluation of each counted model.
    pub(super) fn evaluations(&self) -> Result<Vec<Evaluation>> {
        self.counted().map(|place| self.evaluation(place)).collect()
    }

    /// Evaluation of the scene's true values by the model at index `place` of `models`.
    fn evaluation(&self, place: usize) -> Result<Evaluation> {
        let rung = &self.models[place].rung;
        let mut run = truth(&self.study, rung)?;
        let name = format!("{} {}: {}", self.kind.name(), self.number, rung.name);
        run().with_context(|| name.clone())?;
        Ok(Evaluation::new(name, run))
    }
}

/// Computation that can be repeated; returns its number of contacts or markers.
type Computation = Box<dyn FnMut() -> Result<usize>>;

/// Computes the true values of the first cell's scene by a rung, and nothing else.
fn truth(study: &Study, rung: &Rung) -> Result<Computation> {
    let scene = &study.config.scene;
    match (scene.with_model(&rung.model), &rung.model) {
        (Some(SceneConfig::Roll(_)), _) => rolls(study.with_model(0, rung)?),
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

/// Rolls of all probes.
fn rolls(scene: Scene) -> Result<Computation> {
    let Scene::Roll(scene) = scene else {
        bail!("the scene is not a roll");
    };
    let rolls = scene.noiseless();
    Ok(Box::new(move || {
        for motions in &rolls {
            black_box(scene.roller().shift(motions)?);
        }
        Ok(rolls.len())
    }))
}

/// A contact and the displacements of the markers.
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
