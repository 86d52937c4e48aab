//! Goodness of fit: the chi-squared test.

use crate::chi_squared_tail;

/// Significance level of each test of an estimate: its probability of a false alarm if the model holds.
pub const SIGNIFICANCE_LEVEL: f64 = 0.005;

/// The chi-squared of a fit, compared with the stated noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoodnessOfFit {
    /// Sum of the squared residuals of readings and priors, in standard deviations.
    pub chi_squared: f64,
    /// Degrees of freedom: number of used readings and priors minus number of unknowns.
    pub freedom: usize,
    /// Probability of a chi-squared at least as large, if the model holds and the noise is normal with the stated size. Then it
    /// is uniform from 0 to 1. It is small if the readings contradict the model or the noise; 1 without degrees of freedom.
    pub p_value: f64,
}

impl GoodnessOfFit {
    /// The goodness of a fit with this chi-squared and these degrees of freedom.
    pub fn new(chi_squared: f64, freedom: usize) -> Self {
        Self {
            chi_squared,
            freedom,
            p_value: chi_squared_tail(chi_squared, freedom),
        }
    }

    /// Whether the p-value is below [`SIGNIFICANCE_LEVEL`]. Then patterns must be compared with the residuals instead of the
    /// stated noise: with a stated noise that is too small, every pattern would be significant.
    pub fn is_poor(&self) -> bool {
        self.p_value < SIGNIFICANCE_LEVEL
    }
}
