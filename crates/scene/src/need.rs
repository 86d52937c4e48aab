//! Messages about a scene: the models that it needs, and warnings.

use std::collections::BTreeMap;
use std::fmt;

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

    /// Returns a warning with this text, or `None` without a text.
    pub(crate) fn of(code: &'static str, text: Option<impl Into<String>>) -> Option<Self> {
        text.map(|text| Self::new(code, text, []))
    }
}

/// Message about a scene; `palpate check` prints its `Display` text.
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
