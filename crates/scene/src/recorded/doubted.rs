//! Doubts about an estimate, as they are told.

use palpate_number::Number;
use serde::Serialize;

/// A way in which the readings contradict the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToldDoubt {
    /// Name, as `large-residuals`; help of the command lists those of its estimates.
    name: &'static str,
    /// Probability of readings that contradict it as much where the model holds.
    p_value: f64,
}

macro_rules! told {
    ($($doubt:ty),+) => {$(
        impl From<$doubt> for ToldDoubt {
            fn from(doubt: $doubt) -> Self {
                Self {
                    name: doubt.name(),
                    p_value: doubt.p_value(),
                }
            }
        }
    )+};
}

told!(palpate_ep1::Doubt, palpate_ep2::Doubt, palpate_press::Doubt);

/// Probability by chance of residuals as large, below which there is always a warning.
const ALWAYS_WARNED: f64 = 1e-6;

/// The warning of a fit so poor that noise does not explain it, where no doubt says so.
pub(super) fn poor_fit(p_value: Option<f64>, has_doubts: bool) -> Option<String> {
    let p_value = p_value.filter(|p_value| *p_value < ALWAYS_WARNED && !has_doubts)?;
    let p_value = Number::rounded(p_value);
    Some(format!(
        "the residuals are larger than the stated noise makes them (p-value {p_value}): the readings contradict the model or the noise"
    ))
}
