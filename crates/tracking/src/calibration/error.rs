//! Errors of calibrations.

use palpate_statistics::Number;
use strum::IntoStaticStr;
use thiserror::Error;

/// Reason why there is no calibration, or why it does not apply.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum CalibrationError {
    /// Fewer points than a line needs.
    #[error("{count} {what}; a calibration needs at least {needed}")]
    TooFewPoints {
        /// Name of the things counted: points or parts.
        what: &'static str,
        /// Their number.
        count: usize,
        /// The smallest number.
        needed: usize,
    },
    /// All points have the same displacement.
    #[error(
        "all {count} points have a {what} displacement of {displacement}; a slope needs at least two",
        displacement = Number(*displacement)
    )]
    OneDisplacement {
        /// Kind of displacement: normal or tangential.
        what: &'static str,
        /// The displacement, length.
        displacement: f64,
        /// Number of points.
        count: usize,
    },
    /// A number is not finite.
    #[error("point {point} (counting from 0): a number is not finite, or beyond 1e100")]
    NotFinite {
        /// Index of the point.
        point: usize,
    },
    /// The signal does not change with the displacement.
    #[error("{what} does not change with the displacement: there is no slope to calibrate")]
    NoSlope {
        /// Name of the signal.
        what: &'static str,
    },
    /// A number of a calibration or of a camera is out of its range.
    #[error("{what} is {value}; it must be {needed}", value = Number(*value))]
    OutOfRange {
        /// Name of the number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Allowed values, in words.
        needed: &'static str,
    },
    /// The calibration belongs to a sensor with another number of markers.
    #[error(
        "the calibration is of a sensor with {calibrated} markers; the frame at rest shows {found}"
    )]
    AnotherLayout {
        /// Markers of the sensor that was calibrated.
        calibrated: usize,
        /// Markers found.
        found: usize,
    },
}

impl CalibrationError {
    pub(crate) const fn out_of_range(what: &'static str, value: f64, needed: &'static str) -> Self {
        Self::OutOfRange {
            what,
            value,
            needed,
        }
    }
}
