//! Names of refusals.

use palpate_study::config::ConfigError;

/// Name of a config's error by the field that is wrong: `invalid-scene-object-radius`.
pub(super) fn invalid(error: &ConfigError) -> String {
    let path = if error.path().is_empty() {
        "config"
    } else {
        error.path()
    };
    format!("invalid-{}", path.replace(['.', '_'], "-"))
}
