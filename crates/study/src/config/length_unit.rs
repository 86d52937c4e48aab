//! Unit of the lengths of a study.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The unit of every length of a study. Curvatures are in its inverse.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LengthUnit {
    /// Metre.
    M,
    /// Centimetre.
    Cm,
    /// Millimetre.
    Mm,
    /// Micrometre.
    Um,
    /// Lengths are multiples of a length that the study does not state.
    #[default]
    Unit,
}

impl LengthUnit {
    /// The unit as it stands in configs and column names.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::M => "m",
            Self::Cm => "cm",
            Self::Mm => "mm",
            Self::Um => "um",
            Self::Unit => "unit",
        }
    }
}
