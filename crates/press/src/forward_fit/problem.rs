//! Chi-squared of the readings of a press, and its derivatives.

use nalgebra::{UnitVector3, Vector2, Vector3};

use super::{ForwardFit, Measured, Prior, Reading};
use crate::least_squares::{LeastSquares, minimise};
use crate::markers::{PressSlopes, Sight};
use crate::unknowns::{ACROSS, EXACT, Fitted, OTHERS, State, Sums, Unknowns};
use crate::{Body, Contact, MarkerDisplacement, Place, PressError, Skin};

/// Index of the baseline among the fit parameters. The baseline is an offset of all normal displacements. Fits of
/// images do not have this parameter.
pub(super) const BASELINE: usize = OTHERS;
/// Index of the gain among the fit parameters. The gain is a factor on all normal displacements. Fits of images do not
/// have this parameter.
pub(super) const GAIN: usize = OTHERS + 1;

/// Outlier threshold: a reading is an outlier if its residual exceeds this number of standard deviations. Noise alone
/// causes this once in two million readings.
pub(super) const WRONG: f64 = 5.0;
/// Markers count as a row if the variance of their positions across the row, divided by the variance along the row, is
/// below this value.
const ROW: f64 = 1e-5;

#[derive(Clone, Debug)]
pub(super) struct Problem<'a> {
    pub(super) fit: &'a ForwardFit,
    pub(super) reading: &'a Reading<'a>,
    pub(super) fitted: Fitted,
    pub(super) normal_std: f64,
    pub(super) tangential_std: f64,
    /// For each marker, whether the fit uses it.
    pub(super) kept: Vec<bool>,
    /// Pole of the great circle on which the contact must lie. It is `None` unless all markers are on one great circle
    /// and only their normal displacements are used.
    pub(super) circle: Option<Vector3<f64>>,
    /// Number of standard deviations beyond which a residual has a reduced weight. If this number is infinite, all
    /// weights are equal.
    pub(super) tolerance: f64,
    /// Largest ratio of indentation to relative curvature that the fit may try. The larger this ratio, the wider the
    /// contact. The limit is finite for layers under nearly flat skins, because fits would otherwise try contacts that
    /// are much wider than the layer is thick.
    pub(super) widest: f64,
}

struct Predicted {
    moved: (f64, Vector2<f64>),
    normal_slopes: Unknowns,
    tangential_slopes: [Unknowns; 2],
}

impl<'a> Problem<'a> {
    /// The least-squares problem for a first fit: all markers are used, and all standard deviations are 1.
    pub(super) fn new(fit: &'a ForwardFit, reading: &'a Reading<'a>) -> Self {
        let largest = reading
            .normal
            .iter()
            .fold(0.0, |most: f64, one| most.max(one.abs()));
        let is_sought = |prior: Prior, scale: f64| match prior {
            Prior::Exact => false,
            Prior::Within(std) => std > EXACT * scale,
            Prior::Free => true,
        };
        let around = |prior: Prior, value: f64| match prior {
            Prior::Within(std) => Some(Measured { value, std }),
            Prior::Exact | Prior::Free => None,
        };
        let others = [around(fit.baseline, 0.0), around(fit.gain, 1.0)];
        let markers = reading.markers;
        let mut fitted = Fitted::new(reading.indentation, others);
        fitted.sought[BASELINE] = is_sought(fit.baseline, largest);
        fitted.sought[GAIN] = is_sought(fit.gain, 1.0);
        let mut problem = Self {
            fit,
            reading,
            fitted,
            normal_std: 1.0,
            tangential_std: 1.0,
            kept: vec![true; reading.normal.len()],
            circle: None,
            tolerance: f64::INFINITY,
            widest: match markers.scale() < markers.skin().place_radius() {
                true => fit.body.end_of_tables(),
                false => f64::INFINITY,
            },
        };
        if !problem.uses_tangential() {
            problem.circle = common_circle(reading);
            problem.fitted.sought[ACROSS] = problem.circle.is_none();
        }
        problem
    }

    pub(super) fn keep_window(&mut self, state: &State) {
        let Some(window) = self.fit.window else {
            return;
        };
        let markers = self.reading.markers;
        for (kept, place) in self.kept.iter_mut().zip(markers.places()) {
            *kept = markers.sight(&state.place, place).distance <= window;
        }
    }

    /// The tangential displacements of the reading; `None` if the fit does not use them.
    fn tangential(&self) -> Option<&'a [[f64; 2]]> {
        self.reading
            .tangential
            .filter(|_| !self.fit.body.is_approximate())
    }

    pub(super) fn uses_tangential(&self) -> bool {
        self.tangential().is_some()
    }

    pub(super) fn knows_noise(&self) -> bool {
        let is_stated = |std: Option<f64>| std.is_some_and(|std| std > 0.0);
        is_stated(self.fit.normal_std)
            && (!self.uses_tangential() || is_stated(self.fit.tangential_std))
    }

    /// Number of displacement components that the fit uses per marker: 1 (normal), or 3 if tangential displacements are
    /// also used.
    pub(super) fn components(&self) -> usize {
        if self.uses_tangential() { 3 } else { 1 }
    }

    pub(super) fn sights(&self, place: &Place) -> Vec<Sight> {
        let markers = self.reading.markers;
        let places = markers.places().iter();
        places.map(|marker| markers.sight(place, marker)).collect()
    }

    /// Chi-squared, without its derivatives. The function `moved` returns the normal and the tangential displacement
    /// that the model predicts for a marker.
    pub(super) fn cost(
        &self,
        state: &State,
        moved: impl Fn(usize) -> (f64, Vector2<f64>),
    ) -> Result<f64, PressError> {
        let mut sum = RobustSum::new(self.tolerance);
        for marker in self.counting() {
            sum.add(self.residuals(marker, moved(marker)));
        }
        finite(self.fitted.prior_sums(state).chi_squared + sum.total())
    }

    pub(super) fn sums(&self, state: &State) -> Result<Sums, PressError> {
        match self.uses_tangential() {
            true => self.sums_of::<true>(state),
            false => self.sums_of::<false>(state),
        }
    }

    fn sums_of<const TANGENTIAL: bool>(&self, state: &State) -> Result<Sums, PressError> {
        let contact = self.contact(state)?;
        let [_, slope] = self.fit.body.indentation_of(contact.radius)?;
        let slopes = PressSlopes::new(&contact, slope);
        let mut sums = self.fitted.prior_sums(state);
        let mut robust = RobustSum::new(self.tolerance);
        let [normally, tangentially] = [self.normal_std, self.tangential_std].map(f64::recip);
        for marker in self.counting() {
            let predicted = self.predicted::<TANGENTIAL>(state, &contact, &slopes, marker);
            let residuals = self.residuals(marker, predicted.moved);
            let weight = robust.add(residuals);
            sums.add(residuals[0], weight, &(predicted.normal_slopes * normally));
            if TANGENTIAL {
                for axis in 0..2 {
                    let slopes = predicted.tangential_slopes[axis] * tangentially;
                    sums.add(residuals[1 + axis], weight, &slopes);
                }
            }
        }
        sums.chi_squared += robust.total();
        sums.only(&self.fitted.sought);
        finite(sums.chi_squared + sums.gradient.sum() + sums.hessian.sum())?;
        Ok(sums)
    }

    /// Residuals of a marker for the fit parameters `state`, in standard deviations: one normal and two tangential
    /// residuals. They are 0 for components that the fit does not use.
    pub(super) fn residuals_at(
        &self,
        contact: &Contact<'_>,
        state: &State,
        marker: usize,
    ) -> [f64; 3] {
        self.residuals(marker, moved(contact, state, &self.sight(state, marker)))
    }

    /// Residuals of a marker in a model without a contact, in standard deviations. `baseline` is the offset of the
    /// normal displacements.
    pub(super) fn readings_of(&self, marker: usize, baseline: f64) -> [f64; 3] {
        self.residuals(marker, (baseline, Vector2::zeros()))
    }

    pub(super) fn displacements(
        &self,
        contact: &Contact<'_>,
        state: &State,
    ) -> Vec<MarkerDisplacement> {
        (0..self.kept.len())
            .map(|marker| {
                let (normal, tangential) = moved(contact, state, &self.sight(state, marker));
                MarkerDisplacement {
                    normal,
                    tangential: [tangential.x, tangential.y],
                }
            })
            .collect()
    }

    /// Sum of slope × value over all readings of the used markers. A slope is the derivative of a predicted reading
    /// with respect to the fit parameters. `values` contains one value per reading. Slopes and values are in standard
    /// deviations of the noise.
    pub(super) fn projected(
        &self,
        state: &State,
        values: &[[f64; 3]],
    ) -> Result<Unknowns, PressError> {
        let mut sum = Unknowns::zeros();
        for (slopes, values) in self.slopes(state)?.zip(values) {
            for (slopes, value) in slopes.iter().zip(values) {
                sum += slopes * *value;
            }
        }
        Ok(sum)
    }

    pub(super) fn residuals_of_all(&self, state: &State) -> Result<Vec<[f64; 3]>, PressError> {
        let contact = self.contact(state)?;
        let residuals = |marker| self.residuals_at(&contact, state, marker);
        Ok(self.counting().map(residuals).collect())
    }

    /// Derivatives of the predicted readings with respect to all fit parameters, in standard deviations of the noise.
    /// There is one entry per used marker, with three components: one normal and two tangential.
    pub(super) fn slopes(
        &self,
        state: &State,
    ) -> Result<impl Iterator<Item = [Unknowns; 3]> + use<'_, 'a>, PressError> {
        let contact = self.contact(state)?;
        let [_, slope] = self.fit.body.indentation_of(contact.radius)?;
        let press = PressSlopes::new(&contact, slope);
        let state = *state;
        Ok(self.counting().map(move |marker| {
            let predicted = self.predicted::<true>(&state, &contact, &press, marker);
            let [along_x, along_y] = match self.uses_tangential() {
                true => predicted
                    .tangential_slopes
                    .map(|slopes| slopes / self.tangential_std),
                false => [Unknowns::zeros(); 2],
            };
            [predicted.normal_slopes / self.normal_std, along_x, along_y]
        }))
    }

    /// Numbers of the markers that the fit uses.
    pub(super) fn counting(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.kept.len()).filter(|&marker| self.kept[marker])
    }

    pub(super) fn sight(&self, state: &State, marker: usize) -> Sight {
        let markers = self.reading.markers;
        markers.sight(&state.place, &markers.places()[marker])
    }

    fn residuals(&self, marker: usize, (normal, tangential): (f64, Vector2<f64>)) -> [f64; 3] {
        let normal = (self.reading.normal[marker] - normal) / self.normal_std;
        match self.tangential() {
            Some(measured) => {
                let [x, y] = measured[marker];
                [
                    normal,
                    (x - tangential.x) / self.tangential_std,
                    (y - tangential.y) / self.tangential_std,
                ]
            }
            None => [normal, 0.0, 0.0],
        }
    }

    #[inline]
    fn predicted<const TANGENTIAL: bool>(
        &self,
        state: &State,
        contact: &Contact<'_>,
        slopes: &PressSlopes,
        marker: usize,
    ) -> Predicted {
        let sight = self.sight(state, marker);
        let field = contact.field(sight.distance);
        let curvature = contact.relative_curvature;
        let normal = curvature * field.normal;
        let mut normal_slopes = Unknowns::zeros();
        let [baseline, gain] = state.others;
        let by_press = slopes.normal(&field, &sight, gain);
        normal_slopes.as_mut_slice()[..BASELINE].copy_from_slice(&by_press);
        normal_slopes[BASELINE] = 1.0;
        normal_slopes[GAIN] = normal;
        let mut tangential_slopes = [Unknowns::zeros(); 2];
        if TANGENTIAL {
            let by_press = slopes.tangential(&field, &sight);
            for (slopes, by_press) in tangential_slopes.iter_mut().zip(by_press) {
                slopes.as_mut_slice()[..BASELINE].copy_from_slice(&by_press);
            }
        }
        Predicted {
            moved: (
                gain * normal + baseline,
                sight.outward * (curvature * field.radial),
            ),
            normal_slopes,
            tangential_slopes,
        }
    }

    /// The place on the skin in the direction `direction` from the sensor's centre. If the contact must lie on the
    /// great circle of the markers, the x axis of the place points along this circle.
    pub(super) fn place_at(&self, direction: &Vector3<f64>) -> Place {
        let Some(pole) = self.circle else {
            return self.reading.markers.skin().place_at(direction);
        };
        let direction = UnitVector3::new_normalize(direction - pole * pole.dot(direction));
        Place {
            direction,
            x_axis: pole.cross(&direction),
            y_axis: pole,
        }
    }
}

impl LeastSquares for Problem<'_> {
    type Fit = (State, Sums);
    const SINGULAR: f64 = 1e-7;
    const FREE: &'static str =
        "curvature, position, indentation, baseline and gain cannot be determined separately";
    const ENOUGH_OF_PROFILE: f64 = 1e-4;

    fn state_of((state, _): &Self::Fit) -> &State {
        state
    }

    fn sums_of((_, sums): &Self::Fit) -> &Sums {
        sums
    }

    fn press(&self) -> (&Skin, &Body) {
        (self.reading.markers.skin(), &self.fit.body)
    }

    fn fitted(&self) -> &Fitted {
        &self.fitted
    }

    fn contact(&self, state: &State) -> Result<Contact<'_>, PressError> {
        if state.indentation > self.widest * libm::exp(state.log_curvature) {
            return Err(PressError::OutOfRange);
        }
        let (skin, body) = self.press();
        state.contact(skin, body)
    }

    fn used(&self) -> [usize; 2] {
        [self.counting().count(), self.components()]
    }

    fn estimates_noise(&self) -> bool {
        self.fit.normal_std.is_none_or(|std| std == 0.0)
    }

    fn stepped(&self, state: &State, step: &Unknowns) -> State {
        let skin = self.reading.markers.skin();
        state.stepped(skin, step, |direction| self.place_at(direction))
    }

    fn fit_at(&self, state: State) -> Result<Self::Fit, PressError> {
        Ok((state, self.sums(&state)?))
    }

    fn advance(
        &self,
        (from, sums): &Self::Fit,
        step: &Unknowns,
        _: f64,
    ) -> Result<Option<Self::Fit>, PressError> {
        let fit = self.fit_at(self.stepped(from, step)).ok();
        Ok(fit.filter(|(_, better)| better.chi_squared <= sums.chi_squared))
    }

    fn last_step(&self, (from, sums): &Self::Fit, step: &Unknowns) -> Option<Self::Fit> {
        let state = self.stepped(from, step);
        let is_possible = self.contact(&state).is_ok();
        is_possible.then(|| (state, sums.after(step)))
    }

    fn is_better(&self, (state, sums): &Self::Fit, (_, best): &Self::Fit) -> bool {
        let is_less =
            |sums: &Sums| sums.chi_squared - best.chi_squared < -1e-6 * (1.0 + best.chi_squared);
        // `sums` may be extrapolated from an earlier state. Therefore compute chi-squared at `state` before accepting
        // it.
        is_less(sums) && self.sums(state).is_ok_and(|sums| is_less(&sums))
    }
}

/// Displacement of a marker in the model: the normal displacement, including gain and baseline, and the tangential
/// displacement.
fn moved(contact: &Contact<'_>, state: &State, sight: &Sight) -> (f64, Vector2<f64>) {
    let moved = contact.displacement(sight.distance);
    let [baseline, gain] = state.others;
    let normal = gain * moved.normal + baseline;
    (normal, sight.outward * moved.radial)
}

pub(super) fn finite(value: f64) -> Result<f64, PressError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(PressError::OutOfRange)
    }
}

/// Limit of the product of the terms 1 + s/c² in a [`RobustSum`], where s is the sum of squared residuals of a marker
/// and c the tolerance. If the product exceeds this limit, its logarithm is added to the sum, so that the product
/// cannot overflow.
const MAX_PRODUCT: f64 = 1e100;

/// Robust chi-squared: the sum of Cauchy's loss c² ln(1 + s/c²) over the markers. Here s is the sum of squared
/// residuals of a marker, and c the tolerance. The loss is about s if s is much smaller than c².
pub(super) struct RobustSum {
    limit: f64,
    sum: f64,
    /// Product of the terms 1 + s/c² of some markers, where s is the sum of squared residuals of a marker and c the
    /// tolerance. The logarithm of this product is not yet in `sum`. One logarithm of a product is faster than one
    /// logarithm per marker.
    product: f64,
}

impl RobustSum {
    /// `tolerance` is the tolerance c of Cauchy's loss, in standard deviations. If c is infinite, all residuals have
    /// equal weights.
    pub(super) const fn new(tolerance: f64) -> Self {
        Self {
            limit: tolerance * tolerance,
            sum: 0.0,
            product: 1.0,
        }
    }

    /// Adds the residuals of one marker, in standard deviations, to the robust chi-squared. Returns the weight of the
    /// marker in the normal equations of the fit.
    pub(super) fn add(&mut self, residuals: [f64; 3]) -> f64 {
        let squared: f64 = residuals.iter().map(|residual| residual * residual).sum();
        if self.limit == f64::INFINITY {
            self.sum += squared;
            return 1.0;
        }
        let rise = 1.0 + squared / self.limit;
        let product = self.product * rise;
        if product < MAX_PRODUCT {
            self.product = product;
        } else {
            self.sum += self.limit * (libm::log(self.product) + libm::log(rise));
            self.product = 1.0;
        }
        rise.recip()
    }

    pub(super) fn total(&self) -> f64 {
        if self.product == 1.0 {
            self.sum
        } else {
            self.sum + self.limit * libm::log(self.product)
        }
    }
}

impl Problem<'_> {
    /// The minimum of chi-squared near the fit parameters `state`. If `held` is the index of a fit parameter, this
    /// parameter is held constant.
    pub(super) fn minimum(
        &self,
        state: State,
        enough: f64,
        held: Option<usize>,
    ) -> Result<(State, Sums), PressError> {
        minimise(self, self.fit_at(state)?, enough, held)
    }

    /// Sum of the squared residuals of all markers, in standard deviations. Each marker contributes at most the square
    /// of the outlier threshold. The sum is infinite if the fit parameters `state` describe an impossible contact.
    pub(super) fn unexplained(&self, state: &State) -> f64 {
        let Ok(contact) = self.contact(state) else {
            return f64::INFINITY;
        };
        let square = |marker: usize| {
            let residuals = self.residuals_at(&contact, state, marker);
            let square: f64 = residuals.iter().map(|residual| residual * residual).sum();
            square.min(WRONG * WRONG)
        };
        (0..self.kept.len()).map(square).sum()
    }

    /// Chi-squared of the markers that the fit does not use, computed as if there were no contact.
    pub(super) fn left_out(&self) -> f64 {
        let mut sum = RobustSum::new(self.tolerance);
        for marker in (0..self.kept.len()).filter(|&marker| !self.kept[marker]) {
            sum.add(self.readings_of(marker, 0.0));
        }
        sum.total()
    }
}

/// The pole of the great circle on which all markers lie; `None` if there is no such circle.
fn common_circle(reading: &Reading<'_>) -> Option<Vector3<f64>> {
    let places = reading.markers.places();
    let first = places.first()?;
    let mut spread = nalgebra::Matrix2::zeros();
    for place in places {
        let sight = reading.markers.sight(first, place);
        let along = sight.bearing * sight.reach;
        spread += along * along.transpose();
    }
    let eigen = spread.symmetric_eigen();
    let across = eigen.eigenvectors.column(eigen.eigenvalues.imin());
    (eigen.eigenvalues.min() <= ROW * eigen.eigenvalues.max())
        .then(|| first.x_axis * across[0] + first.y_axis * across[1])
}
