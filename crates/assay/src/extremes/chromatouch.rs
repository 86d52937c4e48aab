//! The colour-marker sensor, at its extremes.

mod layouts;
mod optics;

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    let parts = [layouts::cases(), optics::cases()];
    parts.into_iter().flatten().collect()
}
