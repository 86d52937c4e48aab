//! Pads on a fingertip.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How pads are laid out on the probe.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PadLayout {
    /// A square grid in the arc lengths of the surface.
    #[default]
    Square,
    /// A nearly uniform lattice over the cap.
    Uniform,
}

/// Place of the first contact on the array of pads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PadOffset {
    /// The centre of a pad.
    #[default]
    Centred,
    /// Anywhere within a pad, drawn for each roll.
    Random,
    /// Anywhere within a pad, drawn once per trial: all rolls of the trial start at the same place.
    RandomPerTrial,
}

/// Pads cover the half of the fingertip, in degrees from its middle.
pub(super) fn right_angle() -> f64 {
    90.0
}
