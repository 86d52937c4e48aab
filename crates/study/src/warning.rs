//! Warnings about results.

use std::collections::BTreeMap;

use serde::Serialize;

/// Message that a result may be wrong.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Warning {
    /// Name of the kind of warning in kebab case, for example `large-contact`.
    pub code: &'static str,
    /// The message, one sentence.
    pub text: String,
    /// Numbers of the warning by name; lengths are in the unit of the study or the readings.
    pub numbers: BTreeMap<&'static str, f64>,
}

impl Warning {
    /// A warning of this kind, with the numbers behind it.
    pub fn new<const N: usize>(
        code: &'static str,
        text: impl Into<String>,
        numbers: [(&'static str, f64); N],
    ) -> Self {
        Self {
            code,
            text: text.into(),
            numbers: numbers.into(),
        }
    }

    /// Returns a warning with this text, or `None` without a text.
    pub fn of(code: &'static str, text: Option<impl Into<String>>) -> Option<Self> {
        text.map(|text| Self::new(code, text, []))
    }
}
