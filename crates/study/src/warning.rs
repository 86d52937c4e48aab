//! Warnings that a result may be wrong.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

/// A message that a result may be wrong. `Display` writes it as one line for a terminal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Warning {
    /// Name of the kind of warning, in lower-case words joined by hyphens, for example `large-contact`.
    pub code: String,
    /// The message, in one sentence.
    pub text: String,
    /// Numbers on which the warning is based, with their names. Lengths are in the unit of the study or of the
    /// readings.
    pub numbers: BTreeMap<String, f64>,
}

impl Warning {
    /// Creates a warning from its code, its text, and the numbers on which it is based.
    pub fn new(
        code: &str,
        text: impl Into<String>,
        numbers: impl IntoIterator<Item = (&'static str, f64)>,
    ) -> Self {
        let numbers = numbers.into_iter();
        Self {
            code: code.to_owned(),
            text: text.into(),
            numbers: numbers
                .map(|(name, number)| (name.to_owned(), number))
                .collect(),
        }
    }

    /// Creates a warning without numbers from its code and its text; returns `None` if `text` is `None`.
    pub fn of(code: &str, text: Option<impl Into<String>>) -> Option<Self> {
        text.map(|text| Self::new(code, text, []))
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "warning: {}", self.text)
    }
}
