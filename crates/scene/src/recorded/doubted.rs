//! Doubts about an estimate, as they are told.

use palpate_ep1::Doubt as RollDoubt;
use palpate_ep2::Doubt as GlideDoubt;
use palpate_press::Doubt as PressDoubt;
use serde::Serialize;

/// A way in which the readings contradict the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToldDoubt {
    /// Name, as `large-residuals`; help of the command lists those of its estimates.
    name: &'static str,
    /// Probability of readings that contradict it as much where the model holds.
    p_value: f64,
}

impl From<PressDoubt> for ToldDoubt {
    fn from(doubt: PressDoubt) -> Self {
        Self {
            name: doubt.name(),
            p_value: doubt.p_value(),
        }
    }
}

impl From<RollDoubt> for ToldDoubt {
    fn from(doubt: RollDoubt) -> Self {
        Self {
            name: doubt.name(),
            p_value: doubt.p_value(),
        }
    }
}

impl From<GlideDoubt> for ToldDoubt {
    fn from(doubt: GlideDoubt) -> Self {
        Self {
            name: doubt.name(),
            p_value: doubt.p_value(),
        }
    }
}
