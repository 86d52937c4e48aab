//! The error types for readings and time series of rolls from which the curvature cannot be estimated.

use palpate_statistics::Number;
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Reasons why the curvature cannot be estimated from the readings of a set of probes.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum Ep1Error {
    /// Fewer than two probes. At least two are needed, because a curvature form has three components, and one probe
    /// determines only two of them.
    #[error("{probes} probe(s); at least 2 in different directions are needed")]
    TooFewProbes {
        /// Number of probes with a reading.
        probes: usize,
    },
    /// The rotations of all probes are nearly parallel, so they do not span the tangent plane.
    #[strum(serialize = "unresolvable-set")]
    #[error(
        "the rotations of the {probes} probes do not span the tangent plane: across their main \
         direction they are {} times as large as along it; add a roll across it",
        Number::rounded(*spread)
    )]
    Unresolvable {
        /// Number of probes.
        probes: usize,
        /// Root-mean-square rotation perpendicular to the main axis of the rotations, divided by the root-mean-square
        /// rotation along this axis.
        spread: f64,
    },
    /// The measured rotations are too noisy: in some direction, the variance of their errors exceeds half of the mean
    /// squared rotation.
    #[error(
        "errors of the measured rotations are {} of the squared rotations in some direction, more than 0.5: roll further, \
         or measure the rotations more exactly",
        Number::rounded(*share)
    )]
    NoisyRotations {
        /// Variance of the errors of the measured rotations, divided by the mean squared rotation, in the direction in
        /// which this ratio is largest.
        share: f64,
    },
    /// The contact did not move in some direction, because the object is too sharp for the resolution of the readings.
    #[error("{}", unresolved(*direction_rad, *radius_below))]
    Unresolved {
        /// Direction in which the contact did not move, as an angle from u towards v (rad).
        direction_rad: f64,
        /// Upper bound on the object's radius of curvature in the direction `direction_rad` (length). `None` if no
        /// resolution is stated. Also `None` if the resolution is so coarse that the contact would not have moved even
        /// on a flat object.
        radius_below: Option<f64>,
    },
    /// The contact moved against the direction of the roll, which is impossible for a rolling contact.
    #[error(
        "at {:.1} degrees from u the contact moved by {} per radian, against the direction of the \
         roll: this is not a rolling contact",
        direction_rad.to_degrees(),
        Number::rounded(*travel_per_radian)
    )]
    NotRolling {
        /// Direction in which the contact moved backwards, as an angle from u towards v (rad).
        direction_rad: f64,
        /// Distance (length) that the contact moved per radian of rotation; negative.
        travel_per_radian: f64,
    },
    /// A number in a reading is not finite, or a result computed from this reading is not finite.
    #[error("probe {probe} (counting from 0): the reading is not finite")]
    NotFinite {
        /// Index of the probe, counted from 0.
        probe: usize,
    },
    /// A number in the readings, or a result computed from them, is too large or too small for double precision.
    #[error("the readings are too large or too small for double precision")]
    OutOfRange,
}

fn unresolved(direction_rad: f64, radius_below: Option<f64>) -> String {
    let direction = direction_rad.to_degrees();
    let bound = match radius_below {
        Some(radius) => format!("radius below {}", Number(radius)),
        None => "the radius is too small to say".to_owned(),
    };
    format!("at {direction:.1} degrees from u the contact did not move: {bound}")
}

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
        "no constant curvature agrees with the rotations and pads of all rolls: the curvature changes along the rolls (use \
         trajectory), the rotations have noise (state it), or a roll is wrong, most likely roll {roll} (counting from 0)"
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
