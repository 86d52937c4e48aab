//! Updates the sensor's parameters with the frame at rest and the pressed frame together.
//!
//! The model of the pressed frame is linearised with respect to the sensor's parameters. The linear model is inaccurate
//! if the edges of a marker's two discs nearly touch. The image is then nonlinear within the uncertainty of these
//! parameters. Therefore the model is linearised again at the parameters that fit both frames best, and the fit is
//! continued.

use std::borrow::Cow;

use nalgebra::{DVector, Vector2};

use super::fit_state::FitState;
use super::image_problem::{Problem, Residuals};
use super::view::{MAX_MISALIGNMENT, NUMBERS, Sensor};
use crate::PressError;

impl Problem<'_> {
    /// Difference between two values of each uncertain sensor parameter: the value from the fit at rest, minus the
    /// value in the field `sensor`. The unit is the standard deviation of the parameter's prior.
    pub(super) fn to_rest(&self) -> DVector<f64> {
        let free = self.fit.free();
        let steps = free.iter().map(|&number| {
            (self.rest.common[number] - self.sensor.common[number]) / self.fit.common_stds[number]
        });
        DVector::from_iterator(free.len(), steps)
    }

    /// Misalignment (rad) of the marker `marker` from the fit at rest, minus its misalignment in the field `sensor`.
    pub(super) fn to_rest_of(&self, marker: usize) -> Vector2<f64> {
        Vector2::from(self.rest.misalignments[marker])
            - Vector2::from(self.sensor.misalignments[marker])
    }

    /// Difference between two values of each uncertain sensor parameter: the value that fits both frames best, minus
    /// the value from the fit at rest. The unit is the standard deviation of the parameter's prior.
    pub(super) fn departures(&self, residuals: &Residuals) -> Result<DVector<f64>, PressError> {
        let departures = self
            .root
            .tr_solve_lower_triangular(&self.shared(residuals)?);
        departures.ok_or(PressError::OutOfRange)
    }

    pub(super) fn update_sensor(&mut self, best: &FitState) -> Result<bool, PressError> {
        let sensor = self.updated_sensor(&best.residuals)?;
        Ok(self.linearise_at(sensor))
    }

    /// Linearises the model at the sensor parameters `sensor`. Returns `false` if these parameters are impossible.
    pub(super) fn linearise_at(&mut self, sensor: Sensor) -> bool {
        let rest = self.fit.rest_about(&self.rest, &sensor);
        let is_possible = rest.is_some();
        if let Some(rest) = rest {
            self.rest = Cow::Owned(rest);
            self.sensor = sensor;
        }
        is_possible
    }

    /// The sensor parameters that fit both frames (at rest and pressed) best, computed from the residuals of the
    /// pressed frame for the current parameters.
    pub(super) fn updated_sensor(&self, residuals: &Residuals) -> Result<Sensor, PressError> {
        let departures = self.departures(residuals)?;
        let own = residuals - &self.common * &departures;
        let mut sensor = self.rest.sensor();
        for (&number, departure) in self.fit.free().iter().zip(departures.iter()) {
            sensor.common[number] += departure * self.fit.common_stds[number];
        }
        for (marker, local) in self.rest.local.iter().enumerate() {
            let Some(local) = local else { continue };
            let mut step = &local.follows * &departures;
            if let Some(at) = self.counting.iter().position(|one| *one == marker) {
                let own = own.fixed_rows::<NUMBERS>(NUMBERS * at);
                step += local.spread * self.by_local[at].transpose() * own;
            }
            for (misalignment, step) in sensor.misalignments[marker].iter_mut().zip(step.iter()) {
                *misalignment = (*misalignment + step).clamp(-MAX_MISALIGNMENT, MAX_MISALIGNMENT);
            }
        }
        Ok(sensor)
    }
}
