//! Shares of what chance does, as messages show them.

use std::fmt;

use palpate_number::Number;

/// Least share that is told by its number: how large smaller ones are hangs on tails that no noise has.
const LEAST: f64 = 1e-12;

/// Probability as messages show it.
///
/// ```
/// use palpate_chance::Share;
///
/// assert_eq!(Share(0.00123456).to_string(), "0.00123");
/// assert_eq!(Share(1e-200).to_string(), "fewer than 1e-12");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share(pub f64);

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 < LEAST {
            true => write!(f, "fewer than {}", Number(LEAST)),
            false => write!(f, "{}", Number::rounded(self.0)),
        }
    }
}
