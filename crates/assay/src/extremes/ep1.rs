//! Curvature from a few small rolls, at their extremes.

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    Vec::new()
}
