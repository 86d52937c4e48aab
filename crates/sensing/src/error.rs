//! Error of contacts outside of the pads.

use palpate_statistics::Number;
use thiserror::Error;

/// The contact is outside of the pads, which cover only a cap of the fingertip.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error(
    "the contact is {:.3} degrees from the middle of the pads, but the pads end at {:.3} degrees",
    Number(angle_rad.to_degrees()),
    Number(cap_rad.to_degrees())
)]
pub struct BeyondPads {
    /// Angle (rad) between the contact and the middle of the cap that the pads cover.
    pub angle_rad: f64,
    /// Angle (rad) between the middle and the edge of the cap that the pads cover.
    pub cap_rad: f64,
}

/// Name of this kind of error. It stays the same in all versions.
impl From<BeyondPads> for &'static str {
    fn from(_: BeyondPads) -> Self {
        "beyond-pads"
    }
}
