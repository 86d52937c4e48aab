//! Values that replace what a config says of all cells.

use super::error::{ConfigError, Fault};
use super::load::Study;

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
