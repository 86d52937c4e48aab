//! The ladder of a scene: the models that can compute its true values, and the model that is used.

use palpate_study::config::ModelConfig;

/// The models for the true values of a scene, each with its error or with the reason why it cannot simulate the scene.
/// The models are sorted from the fastest to the slowest; each model is called a rung of the ladder.
///
/// ```
/// use palpate_scene::Scenes;
/// use palpate_study::config::{ModelConfig, RollModelConfig, parse};
///
/// let text = r#"
///     name = "roll-on-a-ball"
///     scene.kind = "roll"
///     scene.probe = { kind = "sphere", radius = 1.0 }
///     scene.object = { kind = "sphere", radius = 4.0 }
///     scene.motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// "#;
/// let ladder = parse("study.toml", text)?.ladder(0)?.ok_or("a roll has a ladder")?;
/// // The roll of a ball on a ball has a closed form, which is the fastest model.
/// assert_eq!(ladder.taken, 0);
/// assert_eq!(ladder.taken().model, ModelConfig::Roll(RollModelConfig::ClosedForm {}));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Ladder {
    /// The models, sorted from the fastest to the slowest. The list includes models that cannot simulate the scene.
    pub rungs: Vec<Rung>,
    /// Index of the model that is used. Either the config names this model, or `auto` chose it.
    pub taken: usize,
    /// Index of the model with which all other models are compared; `None` if there is no common reference.
    pub reference: Option<usize>,
    /// Reason why the model `taken` is used.
    pub reason: String,
    /// Largest relative error that `auto` allows when it chooses a model; `None` if the config names the model.
    pub tolerance: Option<f64>,
}

/// A model for the true values of a scene, with its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Rung {
    /// Name of the model, with its setting (such as a tolerance) if it has one.
    pub name: String,
    /// The model in the form of a config; it is never `auto`.
    pub model: ModelConfig,
    /// Error of the true values, compared with the most accurate model. For a roll, it is the error of the last
    /// contacts, relative to the length scale at the first contact (displacement of the contact per radian). For a
    /// glide, it is the error of the contacts, relative to the radius of the fingertip. For a press, it is the error of
    /// the markers' displacements, relative to the largest displacement.
    pub accuracy: Accuracy,
}

/// Accuracy with which a model computes the true values of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Accuracy {
    /// The model can simulate the scene. The number is its relative error.
    Error(f64),
    /// The model cannot simulate the scene. The text states the reason.
    Impossible(String),
}

impl Accuracy {
    /// The relative error; `None` if the model cannot simulate the scene.
    pub const fn error(&self) -> Option<f64> {
        match self {
            Self::Error(error) => Some(*error),
            Self::Impossible(_) => None,
        }
    }
}

impl From<Result<f64, String>> for Accuracy {
    fn from(measured: Result<f64, String>) -> Self {
        measured.map_or_else(Self::Impossible, Self::Error)
    }
}

impl Ladder {
    pub(crate) fn new(
        rungs: Vec<Rung>,
        taken: &ModelConfig,
        reason: String,
        tolerance: Option<f64>,
    ) -> Self {
        let place = rungs.iter().position(|rung| rung.model == *taken);
        Self {
            taken: place.expect("the named or chosen model is among the rungs"),
            rungs,
            reference: None,
            reason,
            tolerance,
        }
    }

    /// The model that is used, which has the index [`Ladder::taken`].
    pub fn taken(&self) -> &Rung {
        &self.rungs[self.taken]
    }
}
