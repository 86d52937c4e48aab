//! A state of a fit of pictures, with all that was computed there.

use super::law::State;
use super::unknowns::{Residuals, Slopes, Sums};
use crate::definite::solve;

/// Least fall of chi-squared by a step that is far: four standard deviations.
const STUCK: f64 = 16.0;

/// A state with all that was computed there.
#[derive(Clone)]
pub(super) struct Fitted {
    pub(super) state: State,
    pub(super) residuals: Residuals,
    pub(super) slopes: Slopes,
    /// Slope of each counting marker's whitened picture by an inward displacement of both discs, its size.
    pub(super) normal_slopes: Vec<f64>,
    pub(super) sums: Sums,
}

impl Fitted {
    /// Standard deviation of the normal displacement of a marker, of both discs alike, that its own picture tells: the
    /// median of those that count.
    pub(super) fn normal_std(&self) -> f64 {
        let mut stds: Vec<f64> = self
            .normal_slopes
            .iter()
            .map(|slope| slope.recip())
            .collect();
        stds.sort_by(f64::total_cmp);
        stds.get(stds.len() / 2).copied().unwrap_or(f64::INFINITY)
    }

    /// Fall of chi-squared that a whole step promises; 0 where there is none.
    pub(super) fn promise(&self) -> f64 {
        let gradient = self.sums.gradient;
        solve(&self.sums.hessian, &gradient).map_or(0.0, |step| gradient.dot(&step))
    }

    /// Whether it ended far from a minimum, as where no press is possible beyond: a whole step promises to take most of
    /// chi-squared away.
    pub(super) fn is_stuck(&self) -> bool {
        self.promise() > (0.5 * self.sums.chi_squared).max(STUCK)
    }
}
