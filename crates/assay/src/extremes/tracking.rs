//! From frames to displacements, at the extremes.

mod calibration;
mod displacements;
mod frames;

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    let parts = [
        frames::cases(),
        displacements::cases(),
        calibration::cases(),
    ];
    parts.into_iter().flatten().collect()
}
