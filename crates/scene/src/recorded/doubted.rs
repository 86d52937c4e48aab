//! Doubts about an estimate, as they are told.

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
