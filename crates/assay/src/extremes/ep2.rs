//! Patches under gliding fingers, at their extremes.

mod classes;
mod contacts;
mod smoothing;
mod surfaces;

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    let parts = [
        contacts::cases(),
        surfaces::cases(),
        classes::cases(),
        smoothing::cases(),
    ];
    parts.into_iter().flatten().collect()
}
