//! Lines about a scene: the models that it needs, and warnings.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

/// Message that a result may be wrong.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Warning {
    /// Kebab-case name of its kind, as `large-contact`.
    pub code: &'static str,
    /// The message, one sentence.
    pub text: String,
    /// Numbers behind it, by their names; lengths are in the unit of the study or the readings.
    pub numbers: BTreeMap<&'static str, f64>,
}

impl Warning {
    pub(crate) fn new<const N: usize>(
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

    /// The warning with this text, where there is one.
    pub(crate) fn of(code: &'static str, text: Option<impl Into<String>>) -> Option<Self> {
        text.map(|text| Self::new(code, text, []))
    }
}

/// Line about a scene; written as `palpate check` shows it.
#[derive(Clone, Debug, PartialEq)]
pub enum Need {
    /// A model that the scene needs, and why.
    Model(String),
    /// A warning.
    Warning(Warning),
}

impl Need {
    /// The warning, if this need is one.
    pub fn warning(&self) -> Option<&Warning> {
        match self {
            Self::Warning(warning) => Some(warning),
            Self::Model(_) => None,
        }
    }
}

impl From<String> for Need {
    fn from(model: String) -> Self {
        Self::Model(model)
    }
}

impl From<Warning> for Need {
    fn from(warning: Warning) -> Self {
        Self::Warning(warning)
    }
}

impl fmt::Display for Need {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(model) => f.write_str(model),
            Self::Warning(warning) => write!(f, "warning: {}", warning.text),
        }
    }
}
