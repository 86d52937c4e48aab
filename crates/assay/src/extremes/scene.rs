//! Whole scenes of extreme settings, and recorded readings of extreme numbers.

mod files;
mod fingertip;
mod ladder;
mod recorded;
mod trials;

use std::fmt::{self, Debug};

use palpate_study::config::ConfigError;

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    let parts = [
        trials::cases(),
        fingertip::cases(),
        ladder::cases(),
        recorded::cases(),
        files::cases(),
    ];
    parts.into_iter().flatten().collect()
}

/// A scene that is refused, by the field of its config that is wrong, `invalid-scene-object-radius`; or a trial that
/// fails, by its own name.
struct Refused(String);

impl Refused {
    fn of(error: &ConfigError) -> Self {
        let path = if error.path().is_empty() {
            "config"
        } else {
            error.path()
        };
        Self(format!("invalid-{}", path.replace(['.', '_'], "-")))
    }
}

impl Debug for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}
