//! Curvature from a few small rolls, at its extremes.

mod asked;
mod exact;

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    [exact::cases(), asked::cases()]
        .into_iter()
        .flatten()
        .collect()
}
