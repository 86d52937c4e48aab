//! The sum of squares that a fit makes least, with its derivatives.

use nalgebra::{SMatrix, SVector, UnitVector3, Vector2, Vector3};

use super::misfit::Misfit;
use super::reading::{Measured, Reading};
use super::settings::{ForwardFit, Prior};
use crate::markers::Sight;
use crate::press_slopes::PressSlopes;
use crate::{Contact, MarkerDisplacement, Place, PressError};

/// Unknowns, in this order: the logarithm of the relative curvature; steps of the contact's place along the axes there;
/// indentation; baseline; gain.
pub(super) const UNKNOWNS: usize = 6;
pub(super) const CURVATURE: usize = 0;
pub(super) const ALONG: usize = 1;
pub(super) const ACROSS: usize = 2;
pub(super) const INDENTATION: usize = 3;
pub(super) const BASELINE: usize = 4;
pub(super) const GAIN: usize = 5;

/// A residual beyond this many standard deviations is wrong, not noisy: chance brings one in two million.
pub(super) const WRONG: f64 = 5.0;

pub(super) type Unknowns = SVector<f64, UNKNOWNS>;
pub(super) type Square = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Values of the unknowns.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub(super) log_curvature: f64,
    pub(super) place: Place,
    pub(super) indentation: f64,
    pub(super) baseline: f64,
    pub(super) gain: f64,
}

/// The least-squares problem: the readings, the weight of each, and the unknowns that are sought.
#[derive(Clone, Debug)]
pub(super) struct Problem<'a> {
    pub(super) fit: &'a ForwardFit,
    pub(super) reading: &'a Reading<'a>,
    /// Whether each unknown is sought.
    pub(super) sought: [bool; UNKNOWNS],
    /// Standard deviation of a normal displacement, and of a tangential component.
    pub(super) normal_std: f64,
    pub(super) tangential_std: f64,
    /// Whether each marker counts.
    pub(super) kept: Vec<bool>,
    /// The great circle on which the contact must lie, by its pole: that of the markers, where they lie on one and
    /// only their normal displacements are known.
    pub(super) circle: Option<Vector3<f64>>,
    /// Residuals beyond this many standard deviations count less and less; all alike if infinite.
    pub(super) tolerance: f64,
}

/// A sum of squares with its derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    /// Chi-squared, priors included; of residuals beyond the tolerance its logarithmic substitute.
    pub(super) chi_squared: f64,
    /// Half its gradient.
    pub(super) gradient: Unknowns,
    /// Half its Hessian, without second derivatives of the model.
    pub(super) hessian: Square,
}

/// The model's reading of one marker, its normal displacement and the tangential ones, with the derivatives by the
/// unknowns.
struct Predicted {
    moved: (f64, Vector2<f64>),
    normal_slopes: Unknowns,
    tangential_slopes: [Unknowns; 2],
}

impl State {
    pub(super) fn curvature(&self) -> f64 {
        libm::exp(self.log_curvature)
    }
}

impl<'a> Problem<'a> {
    pub(super) fn contact(&self, state: &State) -> Result<Contact<'a>, PressError> {
        let skin = self.reading.markers.skin();
        skin.press(&self.fit.body, state.curvature(), state.indentation)
    }

    /// The tangential readings, if they count.
    fn tangential(&self) -> Option<&'a [[f64; 2]]> {
        self.reading
            .tangential
            .filter(|_| self.fit.body.moves_tangentially())
    }

    pub(super) fn uses_tangential(&self) -> bool {
        self.tangential().is_some()
    }

    /// Whether the noise of all readings that count is stated.
    pub(super) fn knows_noise(&self) -> bool {
        let is_stated = |std: Option<f64>| std.is_some_and(|std| std > 0.0);
        is_stated(self.fit.normal_std)
            && (!self.uses_tangential() || is_stated(self.fit.tangential_std))
    }

    /// Number of displacements of each marker that are read.
    pub(super) fn components(&self) -> usize {
        if self.uses_tangential() { 3 } else { 1 }
    }

    /// Number of equations from the markers that count.
    pub(super) fn equations(&self) -> usize {
        self.components() * self.counting().count()
    }

    pub(super) fn unknowns(&self) -> usize {
        self.sought.iter().filter(|&&sought| sought).count()
    }

    /// Refuses markers that do not determine the unknowns, and the noise where it is found.
    ///
    /// # Errors
    /// [`PressError::TooFewMarkers`].
    pub(super) fn determined(&self) -> Result<(), PressError> {
        let is_noise_found = self.fit.normal_std.is_none_or(|std| std == 0.0);
        let (equations, needed) = (
            self.equations(),
            self.unknowns() + usize::from(is_noise_found),
        );
        if equations >= needed {
            return Ok(());
        }
        Err(PressError::TooFewMarkers {
            markers: self.counting().count(),
            equations,
            needed,
        })
    }

    /// Degrees of freedom: equations, and unknowns that are known beforehand, beyond the unknowns.
    pub(super) fn freedom(&self) -> usize {
        let fit = self.fit;
        let is_known = [
            (INDENTATION, self.reading.indentation.is_some()),
            (BASELINE, matches!(fit.baseline, Prior::Within(_))),
            (GAIN, matches!(fit.gain, Prior::Within(_))),
        ];
        let known = is_known
            .iter()
            .filter(|(unknown, is_known)| *is_known && self.sought[*unknown]);
        (self.equations() + known.count()).saturating_sub(self.unknowns())
    }

    /// The markers as seen from a place.
    pub(super) fn sights(&self, place: &Place) -> Vec<Sight> {
        let markers = self.reading.markers;
        let places = markers.places().iter();
        places.map(|marker| markers.sight(place, marker)).collect()
    }

    /// Chi-squared alone, where the model says how all markers move: normal displacements and tangential ones.
    pub(super) fn cost(
        &self,
        state: &State,
        moved: impl Fn(usize) -> (f64, Vector2<f64>),
    ) -> Result<f64, PressError> {
        let mut misfit = Misfit::new(self.tolerance);
        for marker in self.counting() {
            misfit.add(self.residuals(marker, moved(marker)));
        }
        finite(self.priors(state).0 + misfit.total())
    }

    /// Chi-squared with its derivatives.
    pub(super) fn sums(&self, state: &State) -> Result<Sums, PressError> {
        match self.uses_tangential() {
            true => self.sums_of::<true>(state),
            false => self.sums_of::<false>(state),
        }
    }

    /// Chi-squared with its derivatives, of normal displacements alone or (`TANGENTIAL`) of tangential ones too.
    fn sums_of<const TANGENTIAL: bool>(&self, state: &State) -> Result<Sums, PressError> {
        let contact = self.contact(state)?;
        let [_, slope] = self.fit.body.indentation_of(contact.radius)?;
        let slopes = PressSlopes::new(&contact, slope);
        let (chi_squared, gradient, hessian) = self.priors(state);
        let mut sums = Sums {
            chi_squared,
            gradient,
            hessian,
        };
        let mut misfit = Misfit::new(self.tolerance);
        let [normally, tangentially] = [self.normal_std, self.tangential_std].map(f64::recip);
        for marker in self.counting() {
            let predicted = self.predicted::<TANGENTIAL>(state, &contact, &slopes, marker);
            let residuals = self.residuals(marker, predicted.moved);
            let weight = misfit.add(residuals);
            sums.add(residuals[0], weight, &(predicted.normal_slopes * normally));
            if TANGENTIAL {
                for axis in 0..2 {
                    let slopes = predicted.tangential_slopes[axis] * tangentially;
                    sums.add(residuals[1 + axis], weight, &slopes);
                }
            }
        }
        sums.chi_squared += misfit.total();
        sums.only(&self.sought);
        finite(sums.chi_squared + sums.gradient.sum() + sums.hessian.sum())?;
        Ok(sums)
    }

    /// Residuals of a marker at a state, in standard deviations: normal, and both tangential ones (else 0).
    pub(super) fn residuals_at(
        &self,
        contact: &Contact<'_>,
        state: &State,
        marker: usize,
    ) -> [f64; 3] {
        self.residuals(marker, moved(contact, state, &self.sight(state, marker)))
    }

    /// Residuals of a marker, in standard deviations, if nothing moves it but the baseline.
    pub(super) fn readings_of(&self, marker: usize, baseline: f64) -> [f64; 3] {
        self.residuals(marker, (baseline, Vector2::zeros()))
    }

    /// Displacements of all markers by the model.
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

    /// Σ slopes × values over the markers that count, values and slopes in standard deviations.
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

    /// Residuals of the markers that count.
    pub(super) fn residuals_of_all(&self, state: &State) -> Result<Vec<[f64; 3]>, PressError> {
        let contact = self.contact(state)?;
        let residuals = |marker| self.residuals_at(&contact, state, marker);
        Ok(self.counting().map(residuals).collect())
    }

    /// Slopes of the readings of each marker that counts, by all unknowns, in standard deviations: normal, tangential.
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

    /// Markers that count.
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
        let by_press = slopes.normal(&field, &sight, state.gain);
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
                state.gain * normal + state.baseline,
                sight.outward * (curvature * field.radial),
            ),
            normal_slopes,
            tangential_slopes,
        }
    }

    /// Sum of squares of the deviations from prior knowledge, with half its gradient and half its Hessian.
    fn priors(&self, state: &State) -> (f64, Unknowns, Square) {
        let (mut squared, mut gradient, mut hessian) = (0.0, Unknowns::zeros(), Square::zeros());
        let mut add = |index: usize, off: f64, std: f64| {
            squared += (off / std) * (off / std);
            gradient[index] += off / (std * std);
            hessian[(index, index)] += 1.0 / (std * std);
        };
        if let Some(Measured { value, std }) = self.reading.indentation
            && self.sought[INDENTATION]
        {
            add(INDENTATION, state.indentation - value, std);
        }
        if let Prior::Within(std) = self.fit.baseline
            && self.sought[BASELINE]
        {
            add(BASELINE, state.baseline, std);
        }
        if let Prior::Within(std) = self.fit.gain
            && self.sought[GAIN]
        {
            add(GAIN, state.gain - 1.0, std);
        }
        (squared, gradient, hessian)
    }

    /// The place at a direction; on a circle its x axis goes along it.
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

    /// The state after a step.
    pub(super) fn moved(&self, state: &State, step: &Unknowns) -> State {
        let place = if step[ALONG] == 0.0 && step[ACROSS] == 0.0 {
            state.place
        } else {
            let skin = self.reading.markers.skin();
            self.place_at(&skin.beyond(&state.place, step[ALONG], step[ACROSS]))
        };
        State {
            log_curvature: state.log_curvature + step[CURVATURE],
            place,
            indentation: state.indentation + step[INDENTATION],
            baseline: state.baseline + step[BASELINE],
            gain: state.gain + step[GAIN],
        }
    }
}

impl Sums {
    /// The sums after a small step, as their own slopes foretell them.
    pub(super) fn after(&self, step: &Unknowns) -> Self {
        let along = self.hessian * step;
        Self {
            chi_squared: self.chi_squared + 2.0 * self.gradient.dot(step) + step.dot(&along),
            gradient: self.gradient + along,
            hessian: self.hessian,
        }
    }

    /// The sums with this unknown held.
    pub(super) fn holding(mut self, held: usize) -> Self {
        self.gradient[held] = 0.0;
        self.hessian.row_mut(held).fill(0.0);
        self.hessian.column_mut(held).fill(0.0);
        self.hessian[(held, held)] = 1.0;
        self
    }

    /// Adds an observation with this residual (in standard deviations) and slopes of the prediction.
    fn add(&mut self, residual: f64, weight: f64, slopes: &Unknowns) {
        for row in 0..UNKNOWNS {
            let weighted = weight * slopes[row];
            self.gradient[row] -= weighted * residual;
            for column in 0..=row {
                self.hessian[(row, column)] += weighted * slopes[column];
            }
        }
    }

    /// Completes the Hessian, and takes out unknowns that are not sought.
    fn only(&mut self, sought: &[bool; UNKNOWNS]) {
        for row in 0..UNKNOWNS {
            for column in 0..row {
                if !(sought[row] && sought[column]) {
                    self.hessian[(row, column)] = 0.0;
                }
                self.hessian[(column, row)] = self.hessian[(row, column)];
            }
            if !sought[row] {
                self.gradient[row] = 0.0;
                self.hessian[(row, row)] = 1.0;
            }
        }
    }
}

/// Displacement of a marker by a contact as it is read: the normal one with gain and baseline, and the tangential
/// ones.
fn moved(contact: &Contact<'_>, state: &State, sight: &Sight) -> (f64, Vector2<f64>) {
    let moved = contact.displacement(sight.distance);
    let normal = state.gain * moved.normal + state.baseline;
    (normal, sight.outward * moved.radial)
}

pub(super) fn finite(value: f64) -> Result<f64, PressError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(PressError::OutOfRange)
    }
}
