//! Messages about a scene: the models that it needs, and warnings.

use std::fmt;

use palpate_study::Warning;

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
