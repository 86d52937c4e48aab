//! The ladder of a scene: the models that can compute its true values, and the model used.

use palpate_study::config::ModelConfig;

/// The models (rungs) that can compute the true values of a cell's scene, cheapest first.
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
/// // A ball on a ball rolls in closed form, which is the cheapest rung.
/// assert_eq!(ladder.taken, 0);
/// assert_eq!(ladder.taken().model, ModelConfig::Roll(RollModelConfig::ClosedForm {}));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Ladder {
    /// The rungs, cheapest first, including those that cannot simulate the scene.
    pub rungs: Vec<Rung>,
    /// Index of the rung used: the config names it, or `auto` chose it.
    pub taken: usize,
    /// Index of the rung that all others are compared with; `None` if they have different references.
    pub reference: Option<usize>,
    /// Reason for using that rung.
    pub reason: String,
    /// The largest error that `auto` allows; `None` if the config names a rung.
    pub tolerance: Option<f64>,
}

/// A model that can compute the true values of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Rung {
    /// Name of the model, with its setting.
    pub name: String,
    /// The model in the form of a config; never `auto`.
    pub model: ModelConfig,
    /// Error of the noiseless truth, compared with the ladder's best rung. Roll: error of the last contacts, relative to
    /// the first contact's length scale. Glide: error of contacts, relative to the tip's radius. Press: error of marker
    /// displacements, relative to the largest.
    pub accuracy: Accuracy,
}

/// Accuracy of a rung.
#[derive(Clone, Debug, PartialEq)]
pub enum Accuracy {
    /// The rung simulates the scene with this relative error.
    Error(f64),
    /// The rung cannot simulate the scene, for this reason.
    Impossible(String),
}

impl Accuracy {
    /// The relative error; `None` if the rung cannot simulate the scene.
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
    /// Builds a ladder that uses the rung with the model `taken`. Its rungs have no common reference.
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

    /// The rung used.
    pub fn taken(&self) -> &Rung {
        &self.rungs[self.taken]
    }
}
