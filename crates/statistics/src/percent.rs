//! Shares of what chance does, as messages show them.

use std::fmt;

use crate::Number;

/// Least share that is told by its number: how large smaller ones are hangs on tails that no noise has.
const LEAST: f64 = 1e-12;

/// Probability as messages show it.
///
/// ```
/// use palpate_statistics::Percent;
///
/// assert_eq!(Percent(0.00123456).to_string(), "0.00123");
/// assert_eq!(Percent(1e-200).to_string(), "fewer than 1e-12");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Percent(pub f64);

impl fmt::Display for Percent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 < LEAST {
            true => write!(f, "fewer than {}", Number(LEAST)),
            false => write!(f, "{}", Number::rounded(self.0)),
        }
    }
}
