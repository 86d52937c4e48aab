//! Errors of calibrations.

use palpate_statistics::Number;
use strum::IntoStaticStr;
use thiserror::Error;

/// Why there is no calibration, or why one does not apply.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq)]
#[strum(serialize_all = "kebab-case")]
pub enum CalibrationError {
    /// Fewer points than a line needs.
    #[error("{count} {what}; a calibration needs at least {needed}")]
    TooFewPoints {
        /// Name of the things counted: points or parts.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many it takes.
        needed: usize,
    },
    /// All points show the same displacement.
    #[error(
        "all {count} points have a {what} displacement of {displacement}; a slope needs at least two",
        displacement = Number(*displacement)
    )]
    OneDisplacement {
        /// Normal or tangential.
        what: &'static str,
        /// The displacement, length.
        displacement: f64,
        /// Points.
        count: usize,
    },
    /// A number is not finite.
    #[error("point {point} (counting from 0): a number is not finite, or beyond 1e100")]
    NotFinite {
        /// Which point.
        point: usize,
    },
    /// The signal does not change with the displacement.
    #[error("{what} does not change with the displacement: there is no slope to calibrate")]
    NoSlope {
        /// Name of the signal.
        what: &'static str,
    },
    /// A number of a calibration or of a camera makes no sense, or leaves the range of doubles.
    #[error("{what} is {value}; it must be {needed}", value = Number(*value))]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Allowed values, in words.
        needed: &'static str,
    },
    /// The calibration is of a sensor with another number of markers.
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
    /// The stable name.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}
