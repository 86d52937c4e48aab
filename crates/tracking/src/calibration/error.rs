//! Errors of calibrations.

use palpate_statistics::Number;
use strum::IntoStaticStr;
use thiserror::Error;

/// Reason why a calibration cannot be computed, or does not apply to a sensor.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum CalibrationError {
    /// There are fewer points than a fit of a line needs, or the calibration has no parts.
    #[error("{count} {what}; a calibration needs at least {needed}")]
    TooFewPoints {
        /// Text that states what was counted: points, or parts of the calibration.
        what: &'static str,
        /// Number of points or parts that were counted.
        count: usize,
        /// Smallest number of points or parts that a calibration needs.
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
        /// Displacement that all points have, length.
        displacement: f64,
        /// Number of points to which the line is fitted.
        count: usize,
    },
    /// A number of a calibration point is not finite or too large.
    #[error("point {point} (counting from 0): a number is not finite, or beyond 1e100")]
    NotFinite {
        /// Index of the point that contains the number, counted from 0.
        point: usize,
    },
    /// The signal does not change with the displacement.
    #[error("{what} does not change with the displacement: there is no slope to calibrate")]
    NoSlope {
        /// Name of the signal from which displacements are computed, such as hue or size.
        what: &'static str,
    },
    /// A number of a calibration or of a camera is out of its range.
    #[error("{what} is {value}; it must be {needed}", value = Number(*value))]
    OutOfRange {
        /// Name of the number that is out of range.
        what: &'static str,
        /// Value of the number.
        value: f64,
        /// Allowed values, as text.
        needed: &'static str,
    },
    /// The calibration was made with a sensor that has another number of markers.
    #[error(
        "the calibration is for a sensor with {calibrated} markers, but the frame at rest shows \
         {found}"
    )]
    AnotherLayout {
        /// Number of markers of the calibrated sensor.
        calibrated: usize,
        /// Number of markers found in the frame.
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
