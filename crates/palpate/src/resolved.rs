//! Configs as runs write them.

use palpate_study::config::{Study, StudyConfig, to_toml};

/// Config of a study as TOML with every default written out, and with this version of palpate: what `run.toml` holds.
/// Running it gives the same bytes.
///
/// ```
/// let text = r#"
/// name = "a-ball"
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// "#;
/// let resolved = palpate::resolved(&palpate::parse("a-ball.toml", text)?);
/// assert!(resolved.contains("seed = 0") && resolved.contains("crate_version"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn resolved(study: &Study) -> String {
    to_toml(&StudyConfig {
        crate_version: Some(env!("CARGO_PKG_VERSION").to_owned()),
        ..study.config.clone()
    })
}
