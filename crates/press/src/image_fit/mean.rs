//! The mean of what the pictures leave possible, beside the likeliest.
//!
//! Sensors depart from the one that is meant by chance, in which the pictures are not linear: products of what depths and
//! colours leave unknown pull the likeliest curvature to one side of the mean over all sensors that may be. Laplace's method
//! tells by how much: the mean lies −½ C ∇ ln det H beside the mode, with the Hessian H of half of chi-squared by all that is
//! unknown, and its inverse C (Tierney, Kass and Kadane 1989, to the same order).

use super::fitted::Fitted;
use super::law::State;
use super::problem::Problem;
use super::unknowns::{CURVATURE, Square, Unknowns};
use super::view::View;
use crate::definite::inverse;

/// Step along the way of the curvature, in its standard deviations.
const STEP: f64 = 0.3;
/// Variance of the logarithm of the curvature from which on the pictures tell no more than its order.
const VAGUE: f64 = 1.0;
/// Largest distance of the mean from the mode, in standard deviations, at which that is the next term and not the first.
const FURTHEST: f64 = 1.0;

impl<V: View + Clone> Problem<'_, V> {
    /// Distance of the mean of the logarithm of the curvature from its likeliest value, found from where weights were given; 0
    /// where it cannot be told.
    pub(super) fn mean_beside(&self, weighed: &Fitted, covariance: &Square) -> f64 {
        let variance = covariance[(CURVATURE, CURVATURE)];
        let std = variance.sqrt();
        if variance >= VAGUE {
            return 0.0;
        }
        let along = covariance.column(CURVATURE) / std;
        let slope = || {
            let aside = self.stepped_aside(weighed, &(along * STEP))?;
            Some((aside - self.log_determinant(weighed)?) / STEP)
        };
        let beside = -0.5 * slope().unwrap_or(0.0);
        match beside.is_finite() {
            true => std * beside.clamp(-FURTHEST, FURTHEST),
            false => 0.0,
        }
    }

    /// Logarithm of the determinant after a step of the unknowns, which the sensor follows.
    fn stepped_aside(&self, weighed: &Fitted, step: &Unknowns) -> Option<f64> {
        let moved = &weighed.slopes.jacobian * step;
        let mut sensor = self.learnt(&(&weighed.residuals - moved)).ok()?;
        // The sensor about which weights were given follows as far as that which is likeliest.
        sensor.shift(&self.sensor, &self.learnt(&weighed.residuals).ok()?);
        let state: State = self.stepped(&weighed.state, step);
        let mut there = self.clone();
        if !there.take(sensor) {
            return None;
        }
        let fitted = there.weigh(&state).ok()?;
        there.log_determinant(&fitted)
    }

    /// Logarithm of the determinant of the Hessian by all that is unknown, but for a constant, where weights were given.
    fn log_determinant(&self, fitted: &Fitted) -> Option<f64> {
        let of_press = inverse(&fitted.sums.hessian, 0.0)?.determinant();
        let mut sum = 2.0 * self.root.diagonal().map(libm::log).sum() - libm::log(of_press);
        for (&marker, whiten) in self.counting.iter().zip(&self.whiten) {
            sum -= 2.0 * whiten.diagonal().map(libm::log).sum();
            let spread = self.rest.local[marker].as_ref()?.spread.determinant();
            // Where discs are aligned there is nothing to be known of it.
            if spread > 0.0 {
                sum -= libm::log(spread);
            }
        }
        Some(sum)
    }
}
