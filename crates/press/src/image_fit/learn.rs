//! The sensor as both frames tell it.
//!
//! Departures of a sensor that the frame at rest leaves unknown are taken out of the pressed one to first order. Where discs nearly
//! coincide, so that the edge of one may touch that of the other, pictures bend within what is left unknown: the fit then
//! goes on about the sensor that both frames tell together.

use std::borrow::Cow;

use nalgebra::{DVector, Vector2};

use super::fitted::Fitted;
use super::problem::Problem;
use super::unknowns::Residuals;
use super::view::{MOST_MISALIGNED, NUMBERS, Sensor, View};
use crate::PressError;

impl<V: View> Problem<'_, V> {
    /// Free common departures from `sensor` to the sensor at rest, in their standard deviations.
    pub(super) fn to_rest(&self) -> DVector<f64> {
        let free = self.fit.free();
        let steps = free.iter().map(|&number| {
            (self.rest.common[number] - self.sensor.common[number]) / self.fit.common_stds[number]
        });
        DVector::from_iterator(free.len(), steps)
    }

    /// Misalignment of a marker of the sensor at rest, beyond that of `sensor`, rad.
    pub(super) fn to_rest_of(&self, marker: usize) -> Vector2<f64> {
        Vector2::from(self.rest.misalignments[marker])
            - Vector2::from(self.sensor.misalignments[marker])
    }

    /// Free common departures from the sensor at rest, in their standard deviations, that both frames speak for.
    pub(super) fn departures(&self, residuals: &Residuals) -> Result<DVector<f64>, PressError> {
        let departures = self
            .root
            .tr_solve_lower_triangular(&self.shared(residuals)?);
        departures.ok_or(PressError::OutOfRange)
    }

    /// Goes on about the sensor that both frames tell, after a fit about the present one; whether there is such a sensor.
    pub(super) fn learn(&mut self, best: &Fitted) -> Result<bool, PressError> {
        let sensor = self.learnt(&best.residuals)?;
        Ok(self.take(sensor))
    }

    /// Goes on about a sensor; whether there is such a sensor.
    pub(super) fn take(&mut self, sensor: Sensor) -> bool {
        let rest = self.fit.rest_about(&self.rest, &sensor);
        let is_there = rest.is_some();
        if let Some(rest) = rest {
            self.rest = Cow::Owned(rest);
            self.sensor = sensor;
        }
        is_there
    }

    /// The sensor that both frames tell where these are the residuals about the present one.
    pub(super) fn learnt(&self, residuals: &Residuals) -> Result<Sensor, PressError> {
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
                *misalignment = (*misalignment + step).clamp(-MOST_MISALIGNED, MOST_MISALIGNED);
            }
        }
        Ok(sensor)
    }
}
