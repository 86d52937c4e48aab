//! The ladder of a scene: the models by which its truth can be computed, and which of them is taken.

use crate::config::{ConfigError, ModelConfig, SceneConfig, Study};
use crate::{GlideScene, Scene};

/// The rungs on which the truth of a cell's scene can be computed, cheapest first.
///
/// ```
/// use palpate_scene::config::{ModelConfig, RollModelConfig, parse};
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
    /// The rung that is taken.
    pub fn taken(&self) -> &Rung {
        &self.rungs[self.taken]
    }
}

impl Study {
    /// The ladder of a cell's scene; `None` of one that touches nothing.
    ///
    /// # Errors
    /// As [`Study::estimable_scene`].
    ///
    /// # Panics
    /// If `cell` is not the index of a cell.
    pub fn ladder(&self, cell: usize) -> Result<Option<Ladder>, ConfigError> {
        self.ladder_of(cell, &self.estimable_scene(cell)?)
    }

    /// Ladder of a cell whose scene has been made.
    ///
    /// # Errors
    /// Where the model of another scene than the cell's cannot do what the cell asks for.
    ///
    /// # Panics
    /// If `cell` is not the index of a cell.
    pub fn ladder_of(&self, cell: usize, scene: &Scene) -> Result<Option<Ladder>, ConfigError> {
        let config = &self.cells[cell].config.scene;
        Ok(match (scene, config) {
            (Scene::Roll(scene), SceneConfig::Roll(config)) => Some(scene.ladder(config)),
            (Scene::Glide(_), SceneConfig::Glide(config)) => {
                let ladder = GlideScene::ladder(config);
                Some(ladder.map_err(|error| self.plan_error(cell, error))?)
            }
            (Scene::Press(scene), SceneConfig::Press(config)) => {
                let ladder = scene.ladder(config);
                Some(ladder.map_err(|error| self.plan_error(cell, error))?)
            }
            _ => None,
        })
    }

    /// The scene of a cell on another rung of its ladder.
    ///
    /// # Errors
    /// As [`Study::scene`]: where the rung cannot do the scene, at `scene.model`.
    ///
    /// # Panics
    /// If `cell` is not the index of a cell.
    pub fn with_model(&self, cell: usize, rung: &Rung) -> Result<Scene, ConfigError> {
        let config = &self.cells[cell].config;
        match config.scene.with_model(&rung.model) {
            Some(scene) => self.scene_of(cell, &scene, config.seed),
            None => {
                let message = format!("{} is no model of this kind of scene", rung.name);
                Err(self.error_at(cell, "scene.model", message))
            }
        }
    }
}
