//! The ladder of a scene: the models by which its truth can be computed, and which of them is taken.

use palpate_study::config::ModelConfig;

/// The rungs on which the truth of a cell's scene can be computed, cheapest first.
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
    /// The rungs, cheapest first; those that cannot do the scene are among them.
    pub rungs: Vec<Rung>,
    /// The index of the rung that is taken: the one that the config names, or the choice of `auto`.
    pub taken: usize,
    /// The index of the rung that the errors of the others are held against; `None` where each is held against another.
    pub reference: Option<usize>,
    /// Reason why that rung is taken.
    pub reason: String,
    /// The largest error that `auto` allows; `None` where the config names a rung.
    pub tolerance: Option<f64>,
}

/// A model by which the truth of a scene can be computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Rung {
    /// The model with its setting, in words.
    pub name: String,
    /// The model as it stands in a config: never `auto`.
    pub model: ModelConfig,
    /// How far the noiseless truth is off, against the ladder's best; or why this rung cannot do the scene. Of a roll,
    /// contacts at the end, relative to the first contact's length scale; of a glide, contacts, relative to the tip's
    /// radius; of a press, displacements of markers, relative to the largest.
    pub outcome: Result<f64, String>,
}

impl Ladder {
    /// Ladder of these rungs, of which the one with the model `taken` is taken. Each is held against another.
    pub(crate) fn new(
        rungs: Vec<Rung>,
        taken: &ModelConfig,
        reason: String,
        tolerance: Option<f64>,
    ) -> Self {
        let of_taken = rungs.iter().position(|rung| rung.model == *taken);
        Self {
            taken: of_taken.expect("what is named or chosen is among the rungs"),
            rungs,
            reference: None,
            reason,
            tolerance,
        }
    }

    /// The rung that is taken.
    pub fn taken(&self) -> &Rung {
        &self.rungs[self.taken]
    }
}
