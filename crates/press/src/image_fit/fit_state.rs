//! Fit parameters of an image fit, with the residuals and derivatives at these parameters.

use super::image_problem::{Problem, Residuals, Slopes};
use super::view::NUMBERS;
use crate::least_squares::{LeastSquares, solve};
use crate::unknowns::{Fitted, State, Sums, Unknowns};
use crate::{Body, PressError, Skin};

/// Limit of the predicted decrease of chi-squared in the next undamped step. A step of four standard errors would
/// decrease chi-squared by this value. If the prediction exceeds this limit at the end of a search, the search may have
/// ended far from a minimum.
const STUCK: f64 = 16.0;

/// If the logarithm of the curvature changes by at most this value, the derivatives of the images are reused instead of
/// computed again.
const NEAR: f64 = 0.3;

#[derive(Clone)]
pub(super) struct FitState {
    pub(super) state: State,
    pub(super) residuals: Residuals,
    pub(super) slopes: Slopes,
    /// For each used marker, the sensitivity of its image to an equal inward displacement of both its discs. It is the
    /// norm of the derivatives of the image's four numbers, in standard deviations per length.
    pub(super) normal_slopes: Vec<f64>,
    pub(super) sums: Sums,
    /// Whether the search may reuse derivatives from earlier fit parameters to save time. It reuses them as long as
    /// they predict chi-squared well.
    pub(super) keeps_slopes: bool,
}

impl FitState {
    pub(super) fn keeping_slopes(mut self) -> Self {
        self.keeps_slopes = true;
        self
    }

    /// The fit with the fit parameters `state`, which must be near those of `self`, because the derivatives of `self`
    /// are reused.
    fn near(
        self,
        problem: &Problem<'_>,
        state: State,
        residuals: Residuals,
    ) -> Result<Self, PressError> {
        Ok(Self {
            sums: problem.sums(&state, &residuals, &self.slopes)?,
            state,
            residuals,
            keeps_slopes: true,
            ..self
        })
    }

    /// Typical standard error of a marker's normal displacement: the median over the used markers. Each displacement is
    /// estimated from the image of its marker alone; both discs are assumed to move equally.
    pub(super) fn normal_std(&self) -> f64 {
        let mut stds: Vec<f64> = self
            .normal_slopes
            .iter()
            .map(|slope| slope.recip())
            .collect();
        stds.sort_by(f64::total_cmp);
        stds.get(stds.len() / 2).copied().unwrap_or(f64::INFINITY)
    }

    /// Decrease of chi-squared that is predicted for the next undamped step of the search; 0 if this step cannot be
    /// computed.
    pub(super) fn promise(&self) -> f64 {
        let gradient = self.sums.gradient;
        solve(&self.sums.hessian, &gradient).map_or(0.0, |step| gradient.dot(&step))
    }

    /// Whether the search ended far from a minimum of chi-squared, for example because further steps would be
    /// impossible presses. The criterion is that an undamped step is predicted to decrease chi-squared by more than
    /// half of its value, and by more than [`STUCK`].
    pub(super) fn is_stuck(&self) -> bool {
        self.promise() > (0.5 * self.sums.chi_squared).max(STUCK)
    }
}

impl LeastSquares for Problem<'_> {
    type Fit = FitState;
    const SINGULAR: f64 = 1e-6;
    const FREE: &'static str = "a combination of curvature, position and indentation is \
         undetermined";
    const ENOUGH_OF_PROFILE: f64 = 1e-3;

    fn state_of(fit: &FitState) -> &State {
        &fit.state
    }

    fn sums_of(fit: &FitState) -> &Sums {
        &fit.sums
    }

    fn press(&self) -> (&Skin, &Body) {
        (self.fit.markers.skin(), &self.fit.bodies[0])
    }

    fn fitted(&self) -> &Fitted {
        &self.fitted
    }

    fn used(&self) -> [usize; 2] {
        [self.counting.len(), NUMBERS]
    }

    fn damping(fit: &FitState) -> f64 {
        if fit.keeps_slopes { 0.0 } else { 1e-3 }
    }

    fn stepped(&self, state: &State, step: &Unknowns) -> State {
        let skin = self.fit.markers.skin();
        state.stepped(skin, step, |direction| skin.place_at(direction))
    }

    fn fit_at(&self, state: State) -> Result<FitState, PressError> {
        self.reached(self.tried(state)?)
    }

    fn advance(
        &self,
        from: &FitState,
        step: &Unknowns,
        promise: f64,
    ) -> Result<Option<FitState>, PressError> {
        let state = self.stepped(&from.state, step);
        let tried = self.tried(state).ok();
        let Some(tried) = tried.filter(|tried| tried.cost <= from.sums.chi_squared) else {
            return Ok(None);
        };
        let gain = from.sums.chi_squared - tried.cost;
        // If the derivatives predicted chi-squared well, reuse them at the new state. Otherwise compute them again.
        let is_predicted = match from.keeps_slopes {
            true => gain > 0.3 * promise,
            false => (gain - promise).abs() < 0.2 * promise,
        };
        let fit = match is_predicted {
            true => from.clone().near(self, state, tried.residuals),
            false => self.reached(tried),
        };
        fit.map(Some)
    }

    fn refreshed(&self, fit: &FitState) -> Result<Option<FitState>, PressError> {
        fit.keeps_slopes.then(|| self.fit_at(fit.state)).transpose()
    }

    fn fit_near(&self, fit: &FitState, state: State, step: f64) -> Result<FitState, PressError> {
        match step.abs() < NEAR {
            true => fit.clone().near(self, state, self.residuals(&state)?),
            false => self.fit_at(state),
        }
    }

    fn is_better(&self, fit: &FitState, best: &FitState) -> bool {
        fit.sums.chi_squared - best.sums.chi_squared < -0.05
    }
}
