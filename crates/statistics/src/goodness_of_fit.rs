//! Goodness of fit: how likely chance alone leaves as much unexplained.

use crate::chi_squared_tail;

/// Probability with which each doubt about an estimate arises where the model holds.
pub const SIGNIFICANCE_LEVEL: f64 = 0.005;

/// Probability by chance of all patterns together, below which the likeliest of them is doubted.
pub const SIGNIFICANCE_LEVEL_OF_ALL: f64 = 0.02;

/// Chi-squared of a fit against what noise of the stated size leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoodnessOfFit {
    /// Sum of the squares of what the fit leaves of the readings and of prior knowledge, in standard deviations.
    pub chi_squared: f64,
    /// Degrees of freedom: readings that count and priors, less unknowns.
    pub freedom: usize,
    /// Probability that normally distributed noise of the stated size leaves a chi-squared at least as large where the
    /// model holds: uniform from 0 to 1 there, and small where the readings contradict the model or the noise. 1 without
    /// degrees of freedom.
    pub p_value: f64,
}

impl GoodnessOfFit {
    /// The goodness of a fit that leaves this chi-squared on so many degrees of freedom.
    pub fn new(chi_squared: f64, freedom: usize) -> Self {
        Self {
            chi_squared,
            freedom,
            p_value: chi_squared_tail(chi_squared, freedom),
        }
    }

    /// Whether chance alone leaves as much in fewer than [`SIGNIFICANCE_LEVEL`] of all fits. Patterns in the residuals are then to be judged
    /// by the residuals' own size: noise that is stated too small finds every pattern.
    pub fn is_doubted(&self) -> bool {
        self.p_value < SIGNIFICANCE_LEVEL
    }
}
