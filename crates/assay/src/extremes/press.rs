//! Contacts that press, at their extremes.

mod fit;
mod half_space;
mod layer;
mod shear;
mod skin;

use super::Case;

pub(super) fn cases() -> Vec<Case> {
    let parts = [
        half_space::cases(),
        layer::cases(),
        shear::cases(),
        skin::cases(),
        fit::cases(),
    ];
    parts.into_iter().flatten().collect()
}
