//! The model of any kind of scene, as it stands in `scene.model`.

use serde::Serialize;

use super::glide::GlideModelConfig;
use super::press::PressModelConfig;
use super::roll::RollModelConfig;
use super::study::SceneConfig;

/// How the truth of a scene is computed: what stands in `scene.model`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ModelConfig {
    /// Model of a roll.
    Roll(RollModelConfig),
    /// Model of a glide.
    Glide(GlideModelConfig),
    /// Model of a press.
    Press(PressModelConfig),
}

impl SceneConfig {
    /// Its model; `None` of a scene that touches nothing.
    pub fn model(&self) -> Option<ModelConfig> {
        match self {
            Self::Roll(roll) => Some(ModelConfig::Roll(roll.model.clone())),
            Self::Press(press) => Some(ModelConfig::Press(press.model.clone())),
            Self::Glide(glide) => Some(ModelConfig::Glide(glide.model.clone())),
            Self::Fingertip(_) => None,
        }
    }

    /// Scene with another model, an estimator keeping the model that it has from this one; `None` where the model is of
    /// another kind of scene.
    #[must_use]
    pub fn with_model(&self, model: &ModelConfig) -> Option<Self> {
        let mut scene = self.clone();
        match (&mut scene, model) {
            (Self::Roll(roll), ModelConfig::Roll(model)) => roll.model = model.clone(),
            (Self::Glide(glide), ModelConfig::Glide(model)) => glide.model = model.clone(),
            (Self::Press(press), ModelConfig::Press(model)) => {
                let (thickness, poisson) = (press.model.thickness(), press.model.poisson());
                press.estimator.keep(thickness, poisson);
                press.model = model.clone();
            }
            _ => return None,
        }
        Some(scene)
    }
}
