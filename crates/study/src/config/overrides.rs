//! Values that replace what a config says of all cells.

use super::error::{ConfigError, Fault};
use super::load::Study;
use super::model::ModelConfig;
use super::study::SceneConfig;

impl Study {
    /// Replaces the seed of all cells.
    ///
    /// # Errors
    /// When the config sweeps the seed, or it is larger than a TOML integer can be.
    pub fn override_seed(&mut self, seed: u64) -> Result<(), ConfigError> {
        self.check_override("seed", seed, 0)?;
        self.config.seed = seed;
        Ok(())
    }

    /// Replaces the number of trials of all cells.
    ///
    /// # Errors
    /// When the config sweeps the number, or it is 0 or larger than a TOML integer can be.
    pub fn override_trials(&mut self, trials: u64) -> Result<(), ConfigError> {
        self.check_override("trials", trials, 1)?;
        self.config.trials = trials;
        Ok(())
    }

    /// Replaces the model of all cells.
    ///
    /// # Errors
    /// When the config sweeps the model or a part of it, or the model is of another kind of scene.
    pub fn override_model(&mut self, model: &ModelConfig) -> Result<(), ConfigError> {
        const PATH: &str = "scene.model";
        let is_of_model = |path: &str| path == PATH || path.starts_with("scene.model.");
        let fault = |span, message: &str| {
            Err(self.source.error(Fault {
                span,
                path: PATH.into(),
                message: message.into(),
            }))
        };
        if let Some(target) = self.grid.targets().find(|target| is_of_model(&target.path)) {
            return fault(Some(target.span.clone()), "is swept, and so cannot be set");
        }
        let fits = |scene: &SceneConfig| scene.with_model(model);
        let is_of_all = self.cells().all(|cell| fits(&cell.config.scene).is_some());
        match fits(&self.config.scene) {
            Some(scene) if is_of_all => {
                self.config.scene = scene;
                self.model = Some(model.clone());
                Ok(())
            }
            _ => fault(None, "is of another kind of scene"),
        }
    }

    fn check_override(&self, key: &str, value: u64, least: u64) -> Result<(), ConfigError> {
        let fault = |span, message| {
            Err(self.source.error(Fault {
                span,
                path: key.into(),
                message,
            }))
        };
        if let Some(target) = self.grid.targets().find(|target| target.path == key) {
            return fault(
                Some(target.span.clone()),
                format!("is swept, and so cannot be set to {value}"),
            );
        }
        if !(least..=i64::MAX as u64).contains(&value) {
            return fault(
                None,
                format!("must be between {least} and {}, is {value}", i64::MAX),
            );
        }
        Ok(())
    }
}
