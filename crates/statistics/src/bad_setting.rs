//! The error of a setting that is out of its range.

use thiserror::Error;

use crate::Number;

/// Setting that is out of its range. `Words` is the type of the text that says which values are allowed.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("{setting} is {value}; it must be {expected}", value = Number(*value))]
pub struct BadSetting<Words = &'static str> {
    /// Name of the setting, as in the config.
    pub setting: &'static str,
    /// Its value.
    pub value: f64,
    /// Values that the setting may have, in words that follow "must be".
    pub expected: Words,
}

impl<Words> BadSetting<Words> {
    /// The value of a setting, if it is within its range.
    ///
    /// # Errors
    /// [`BadSetting`] unless `holds`.
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
