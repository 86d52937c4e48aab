//! Goodness of fit: the chi-squared test whether noise explains the residuals of a fit.

use crate::chi_squared_tail;

/// Significance level of each test that checks an estimate. It is the probability of a false alarm if the model is
/// correct.
pub const SIGNIFICANCE_LEVEL: f64 = 0.005;

/// Chi-squared of a fit, and the p-value for the hypothesis that the stated noise explains the residuals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoodnessOfFit {
    /// Sum over all readings and priors of (residual / standard deviation)².
    pub chi_squared: f64,
    /// Degrees of freedom: the number of readings and priors that the fit uses, minus the number of fitted parameters.
    pub freedom: usize,
    /// Probability of a chi-squared that is at least as large as this one, if the model is correct and the noise is
    /// normal with the stated size. A small p-value means that the readings contradict the model or the stated noise.
    /// If the readings agree with the model and the noise, the p-value is distributed uniformly from 0 to 1. Without
    /// degrees of freedom, the p-value is 1.
    pub p_value: f64,
}

impl GoodnessOfFit {
    /// Goodness of fit for a chi-squared with `freedom` degrees of freedom.
    pub fn new(chi_squared: f64, freedom: usize) -> Self {
        Self {
            chi_squared,
            freedom,
            p_value: chi_squared_tail(chi_squared, freedom),
        }
    }

    /// Whether the p-value is below [`SIGNIFICANCE_LEVEL`]. If it is, the stated noise may be too small, so that every
    /// pattern in the residuals would seem significant. Compare patterns with the scatter of the residuals then, not
    /// with the stated noise.
    pub fn is_poor(&self) -> bool {
        self.p_value < SIGNIFICANCE_LEVEL
    }
}
