//! The error type for time series of rolls from which the curvature cannot be estimated.

use palpate_statistics::Number;
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Reasons why the curvature cannot be estimated from a set of time series of rolls. Rolls and samples are counted from
/// 0.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum SeriesError {
    /// The radius of the probe, the pitch of the pads or a standard deviation of the noise is out of range.
    #[error("the probe's radius, the pitch of the pads or a noise is out of range")]
    OutOfRange,
    /// A number in a sample is not finite.
    #[error("roll {roll}, sample {sample} (counting from 0): a number is not finite")]
    NotFinite {
        /// Index of the roll, counted from 0.
        roll: usize,
        /// Index of the sample in the roll, counted from 0.
        sample: usize,
    },
    /// A time is not later than the time of the sample before.
    #[error(
        "roll {roll}, sample {sample} (counting from 0): the time {} s is not after the time {} s of the sample before",
        Number(*time_s),
        Number(*last_s)
    )]
    TimeOrder {
        /// Index of the roll, counted from 0.
        roll: usize,
        /// Index of the sample in the roll, counted from 0.
        sample: usize,
        /// Time (s) of the sample.
        time_s: f64,
        /// Time (s) of the previous sample.
        last_s: f64,
    },
    /// The contact point or pad of a sample is more than half a turn of the probe away from the origin of the pads'
    /// coordinates.
    #[error("roll {roll}, sample {sample} (counting from 0): the place is not on the probe")]
    OffProbe {
        /// Index of the roll, counted from 0.
        roll: usize,
        /// Index of the sample in the roll, counted from 0.
        sample: usize,
    },
    /// Too few rolls are usable.
    #[error("{rolls} usable roll(s); at least 2 in different directions are needed")]
    TooFewRolls {
        /// Number of usable rolls.
        rolls: usize,
    },
    /// The readings do not determine the curvature in some direction.
    #[error(
        "the readings do not determine the curvature at {:.1} degrees from u; add a roll in this direction, roll further, or \
         check the signs and axes of the rotations",
        direction_rad.to_degrees()
    )]
    Undetermined {
        /// Direction in which the curvature is undetermined, as an angle from u towards v (rad).
        direction_rad: f64,
    },
    /// No constant curvature agrees with the rotations and pads of all rolls.
    #[error(
        "no constant curvature agrees with the rotations and pads of the rolls; roll {roll} (counting from 0) contradicts \
         the others most: state the noise of the rotations, or let the curvature change along the rolls (trajectory)"
    )]
    Contradiction {
        /// Index (from 0) of the roll that contradicts the other rolls most.
        roll: usize,
    },
    /// The curvature changes along the rolls, but the method assumes that it is constant.
    #[error(
        "the curvature changes along the rolls (p-value of a constant curvature {}): use method trajectory, or roll less far",
        Number::rounded(*p_value)
    )]
    ChangingCurvature {
        /// P-value: probability of such a change by chance if the curvature is constant.
        p_value: f64,
    },
    /// The contact moved against the direction of the rolls.
    #[error("the contact moved against the direction of the rolls: this is not a rolling contact")]
    NotRolling,
}
