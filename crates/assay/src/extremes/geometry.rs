//! Surfaces, charts, closest points, curvature and formulas, at their extremes.

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    Vec::new()
}
