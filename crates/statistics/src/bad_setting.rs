//! The error for a setting whose value is out of its range.

use thiserror::Error;

use crate::Number;

/// Error: the value of a setting is out of its range. `Words` is the type of the field `expected`.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("{setting} is {value}; it must be {expected}", value = Number(*value))]
pub struct BadSetting<Words = &'static str> {
    /// Name of the setting, as in the config.
    pub setting: &'static str,
    /// Value of the setting that is out of range.
    pub value: f64,
    /// The allowed values of the setting, as text that follows "must be".
    pub expected: Words,
}

impl<Words> BadSetting<Words> {
    /// Returns `value` if `holds` is true, that is, if the value of the setting is within its range.
    ///
    /// # Errors
    /// [`BadSetting`] if `holds` is false.
    pub fn unless(
        holds: bool,
        setting: &'static str,
        value: f64,
        expected: impl Into<Words>,
    ) -> Result<f64, Self> {
        if holds {
            return Ok(value);
        }
        let expected = expected.into();
        Err(Self {
            setting,
            value,
            expected,
        })
    }
}
