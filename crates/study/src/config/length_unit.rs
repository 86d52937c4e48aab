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

    /// Number of these in another unit: 1000 for metres in millimetres. `None` where only one of them is of the metric
    /// system.
    pub fn to(self, other: Self) -> Option<f64> {
        let per_metre = |unit| match unit {
            Self::M => Some(1.0),
            Self::Cm => Some(1e2),
            Self::Mm => Some(1e3),
            Self::Um => Some(1e6),
            Self::Unit => None,
        };
        match (per_metre(self), per_metre(other)) {
            (Some(these), Some(others)) => Some(others / these),
            (None, None) => Some(1.0),
            _ => None,
        }
    }
}
