//! Workloads that fit surfaces to contact points (EP2).

use std::hint::black_box;

use anyhow::Result;
use nalgebra::{Point3, Vector3};
use palpate_ep2::{Contact, Ep2Error, Fit, Method, Patch, Penalised};
use palpate_sensing::{Channel, Stream};

use crate::accuracy::rms;
use crate::timing::Evaluation;

/// Radius of the sphere on which the contacts of [`few`] lie, in units of the distance between fingers.
pub const RADIUS: f64 = 5.0;
const SEED: u64 = 1;
/// Largest error of a coordinate in [`few`], in units of the distance between fingers, which is 1.
const MAX_ERROR_OF_FEW: f64 = 0.05;
/// Largest error of a height in [`many`].
const MAX_ERROR_OF_MANY: f64 = 0.02;

/// Few contacts: ten for each of three fingers. The fingers move along y = −1, 0 and 1 on a sphere that is centred at
/// the origin. Each coordinate has a uniformly distributed error.
pub fn few(trial: u64) -> Vec<Contact> {
    let mut noise = Stream::new(SEED, trial, Channel::Position);
    let mut contacts = Vec::new();
    for finger in 0..3 {
        for step in 0..10 {
            let (x, y) = (-1.5 + f64::from(step) / 3.0, finger as f64 - 1.0);
            let z = (RADIUS * RADIUS - x * x - y * y).sqrt();
            let error = Vector3::from_fn(|_, _| MAX_ERROR_OF_FEW * noise.symmetric_uniform());
            contacts.push(Contact::new(finger, Point3::new(x, y, z) + error, None));
        }
    }
    contacts
}

/// Many contacts at random places of the surface z = 0.2 sin 2x cos 2y. Each height has a uniformly distributed error.
pub fn many(count: usize) -> Vec<Contact> {
    let mut noise = Stream::new(SEED, 0, Channel::Position);
    let mut uniform = |most: f64| most * noise.symmetric_uniform();
    (0..count)
        .map(|_| {
            let (x, y) = (uniform(1.5), uniform(1.5));
            let z = 0.2 * libm::sin(2.0 * x) * libm::cos(2.0 * y) + uniform(MAX_ERROR_OF_MANY);
            Contact::new(0, Point3::new(x, y, z), None)
        })
        .collect()
}

/// A patch that consists of these contacts, with its normal along the z axis.
///
/// # Errors
/// [`Ep2Error`] if the contacts do not form a patch.
pub fn patch(contacts: &[Contact]) -> Result<Patch, Ep2Error> {
    Patch::new(contacts, &Vector3::z())
}

/// A grid of 30 × 30 places on the sphere. It covers the rectangle that the contacts of [`few`] would cover if they had
/// no errors.
pub fn places_on_sphere() -> Vec<Point3<f64>> {
    let along = |index: usize, end: f64| end * (2.0 * (index as f64) / 29.0 - 1.0);
    let place = |index: usize| {
        let (x, y) = (along(index / 30, 1.5), along(index % 30, 1.0));
        Point3::new(x, y, (RADIUS * RADIUS - x * x - y * y).sqrt())
    };
    (0..900).map(place).collect()
}

/// A grid of 30 × 30 places on the surface of [`many`], each with its true mean curvature (positive at a peak).
fn places_on_waves() -> impl Iterator<Item = (Point3<f64>, f64)> {
    let along = |index: usize, end: f64| end * (2.0 * (index as f64) / 29.0 - 1.0);
    let place = move |index: usize| {
        let (x, y) = (along(index / 30, 1.5), along(index % 30, 1.0));
        let z = 0.2 * libm::sin(2.0 * x) * libm::cos(2.0 * y);
        let (p, q) = (
            0.4 * libm::cos(2.0 * x) * libm::cos(2.0 * y),
            -0.4 * libm::sin(2.0 * x) * libm::sin(2.0 * y),
        );
        let (r, s, t) = (
            -4.0 * z,
            -0.8 * libm::cos(2.0 * x) * libm::sin(2.0 * y),
            -4.0 * z,
        );
        let square = 1.0 + p * p + q * q;
        let twice = (1.0 + q * q) * r - 2.0 * p * q * s + (1.0 + p * p) * t;
        (Point3::new(x, y, z), -0.5 * twice / libm::pow(square, 1.5))
    };
    (0..900).map(place)
}

/// Root-mean-square error (1/length) of the mean curvature of a fit to the contacts of [`many`].
///
/// # Errors
/// An error if the fit has no curvature at one of the points.
pub fn error_on_waves(fit: &Fit) -> Result<f64, Ep2Error> {
    let off = |(place, mean): (Point3<f64>, f64)| Ok(fit.curvature_at(&place)?.mean - mean);
    let errors: Result<Vec<f64>, Ep2Error> = places_on_waves().map(off).collect();
    errors.map(rms)
}

/// The workload that fits contacts with a method.
///
/// # Errors
/// An error if the contacts do not form a patch.
pub fn fit(name: &str, method: impl Method + 'static, contacts: &[Contact]) -> Result<Evaluation> {
    let patch = patch(contacts)?;
    Ok(Evaluation::new(name, move || method.fit(black_box(&patch))))
}

/// The workload that estimates a surface from contacts with the penalised spline, without standard errors.
///
/// # Errors
/// An error if the contacts do not form a patch.
pub fn estimate(name: &str, method: Penalised, contacts: &[Contact]) -> Result<Evaluation> {
    let patch = patch(contacts)?;
    Ok(Evaluation::new(name, move || {
        method.estimate(black_box(&patch))
    }))
}

/// The workload that computes a curvature map of a fit, with this number of places along each side.
///
/// # Errors
/// An error if the method cannot fit the contacts.
pub fn map(
    name: &str,
    method: &dyn Method,
    contacts: &[Contact],
    side: usize,
) -> Result<Evaluation> {
    let fit = method.fit(&patch(contacts)?)?;
    Ok(Evaluation::new(name, move || {
        black_box(&fit).curvatures(side)
    }))
}
