//! Errors of impossible sensors, and of readings that cannot be taken.

use palpate_statistics::Number;
use thiserror::Error;

/// A parameter that makes no sensor.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{parameter} is {value}; it must be {expected}", value = Number(*value))]
pub struct InvalidSensor {
    /// Name of the parameter, as in the config.
    pub parameter: &'static str,
    /// Its value.
    pub value: f64,
    /// Values that the parameter may have, in words that follow "must be".
    pub expected: String,
}

impl InvalidSensor {
    pub(crate) fn unless(
        holds: bool,
        parameter: &'static str,
        value: f64,
        expected: &str,
    ) -> Result<f64, Self> {
        if holds {
            return Ok(value);
        }
        Err(Self {
            parameter,
            value,
            expected: expected.to_owned(),
        })
    }
}

/// The contact left the part of the fingertip that carries pads.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error(
    "the contact is {:.3} degrees from the middle of the pads, which end at {:.3}",
    Number(angle_rad.to_degrees()),
    Number(cap_rad.to_degrees())
)]
pub struct BeyondPads {
    /// Angle of the contact from the middle of the cap.
    pub angle_rad: f64,
    /// Angle at which the pads end.
    pub cap_rad: f64,
}

impl BeyondPads {
    /// The stable name of this kind of error.
    pub const fn name(&self) -> &'static str {
        "beyond-pads"
    }
}
