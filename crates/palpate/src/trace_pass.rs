//! Traces one trial of a study.

use palpate_scene::{Scenes, Trace, TraceError};
use palpate_study::config::{FieldError, Study};

/// Traces one trial of a cell. If `trial` is a number, traces the trial with this number and its noise. If `trial` is
/// `None`, traces a trial without noise.
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
/// [`TraceError`] if the config is invalid or the trial cannot be traced.
pub fn trace(study: &Study, cell: usize, trial: Option<u64>) -> Result<Trace, TraceError> {
    let unit = study.config.length_unit;
    let trace = study.scene(cell)?.trace(trial, unit);
    trace.map_err(|error| match error {
        TraceError::Untouched => study
            .error_at(0, FieldError::at("scene.kind", error))
            .into(),
        error => error,
    })
}
