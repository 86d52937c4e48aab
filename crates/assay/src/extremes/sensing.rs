//! Pads, lattices, streams and noise, at their extremes.

mod made;
mod noise;
mod pads;

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    let parts = [made::cases(), pads::cases(), noise::cases()];
    parts.into_iter().flatten().collect()
}
