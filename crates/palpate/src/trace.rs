//! One pass of a cell, written down.

use palpate_scene::{Scenes, Trace};
use palpate_study::config::{ConfigError, Study};
use thiserror::Error;

use crate::error::{CellError, known_cell};

/// Pass that cannot be followed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TraceError {
    /// Cell without a scene.
    #[error(transparent)]
    Cell(#[from] CellError),
    /// Pass that could not be completed.
    #[error(transparent)]
    Pass(palpate_scene::TraceError),
}

impl From<ConfigError> for TraceError {
    fn from(error: ConfigError) -> Self {
        Self::Cell(error.into())
    }
}

/// Follows one pass of a cell: noiseless, or as in trial number `trial`.
///
/// ```
/// let text = r#"
/// name = "a-ball"
/// length_unit = "mm"
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0, directions_deg = [0.0, 90.0] }
/// "#;
/// let study = palpate::parse("a-ball.toml", text)?;
/// let trace = palpate::trace(&study, 0, None)?;
/// assert_eq!(trace.what, "202 contacts of 2 probes");
/// assert!(palpate::trace(&study, 1, None).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`TraceError`].
pub fn trace(study: &Study, cell: usize, trial: Option<u64>) -> Result<Trace, TraceError> {
    known_cell(study, cell)?;
    let pass = study.scene(cell)?.trace(trial, study.config.length_unit);
    pass.map_err(|error| match error {
        palpate_scene::TraceError::Untouched => {
            study.error_at(cell, "scene.kind", error.to_string()).into()
        }
        error => TraceError::Pass(error),
    })
}
