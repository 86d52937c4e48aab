//! The model of any kind of scene, as it stands in `scene.model`.

use serde::Serialize;

use super::press::PressModelConfig;
use super::roll::RollModelConfig;
use super::study::SceneConfig;

/// How the truth of a scene is computed: what stands in `scene.model`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ModelConfig {
    /// Of a roll.
    Roll(RollModelConfig),
    /// Of a press.
    Press(PressModelConfig),
}

impl SceneConfig {
    /// Its model; `None` of a scene that touches nothing.
    pub fn model(&self) -> Option<ModelConfig> {
        match self {
            Self::Roll(roll) => Some(ModelConfig::Roll(roll.model.clone())),
            Self::Press(press) => Some(ModelConfig::Press(press.model.clone())),
            Self::Glide(_) | Self::Fingertip(_) => None,
        }
    }

    /// The same scene with another model; `None` where that is of another kind of scene.
    #[must_use]
    pub fn with_model(&self, model: &ModelConfig) -> Option<Self> {
        let mut scene = self.clone();
        match (&mut scene, model) {
            (Self::Roll(roll), ModelConfig::Roll(model)) => roll.model = model.clone(),
            (Self::Press(press), ModelConfig::Press(model)) => press.model = model.clone(),
            _ => return None,
        }
        Some(scene)
    }
}
