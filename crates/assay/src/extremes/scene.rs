//! Whole scenes of extreme settings, and recorded readings of extreme numbers.

mod recorded;
mod trials;

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    let parts = [trials::cases(), recorded::cases()];
    parts.into_iter().flatten().collect()
}
