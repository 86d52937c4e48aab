//! The trace of one pass of a trial.

use palpate_scene::{Scenes, Trace, TraceError as PassError};
use palpate_study::config::{ConfigError, Study};
use thiserror::Error;

/// Reason why a pass cannot be traced.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TraceError {
    /// Invalid field, scene without contact, or a number that is not a cell of the study.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Pass that ends early, or that the sensor cannot read.
    #[error(transparent)]
    Pass(PassError),
}

/// Traces one pass of a cell: without noise, or as in trial number `trial`.
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
    let unit = study.config.length_unit;
    let trace = study.scene(cell)?.trace(trial, unit);
    trace.map_err(|error| match error {
        PassError::Untouched => study.error_at(0, "scene.kind", error.to_string()).into(),
        error => TraceError::Pass(error),
    })
}
