//! Contacts for EP2.

use std::hint::black_box;

use anyhow::Result;
use nalgebra::{Point3, Vector3};
use palpate_ep2::{Contact, Ep2Error, Fit, Method, Patch, Penalised};
use palpate_sensing::{Channel, Stream};

use crate::accuracy::rms;
use crate::measured::Evaluation;

/// Radius of the sphere that few contacts are on.
pub const RADIUS: f64 = 5.0;
const SEED: u64 = 1;
/// Most by which a coordinate of few contacts errs: 5 % of the distance between fingers.
const FEW_OFF: f64 = 0.05;
/// Most by which the height of many contacts errs.
const MANY_OFF: f64 = 0.02;

/// Ten points of each of three fingers at y = −1, 0 and 1 on a sphere about the origin; each coordinate errs uniformly.
pub fn few(trial: u64) -> Vec<Contact> {
    let mut noise = Stream::new(SEED, trial, Channel::Position);
    let mut contacts = Vec::new();
    for finger in 0..3 {
        for step in 0..10 {
            let (x, y) = (-1.5 + f64::from(step) / 3.0, finger as f64 - 1.0);
            let z = (RADIUS * RADIUS - x * x - y * y).sqrt();
            let error = Vector3::from_fn(|_, _| FEW_OFF * noise.symmetric_uniform());
            contacts.push(Contact::new(finger, Point3::new(x, y, z) + error, None));
        }
    }
    contacts
}

/// Points scattered over z = 0.2 sin 2x cos 2y; the heights err uniformly.
pub fn many(count: usize) -> Vec<Contact> {
    let mut noise = Stream::new(SEED, 0, Channel::Position);
    let mut uniform = |most: f64| most * noise.symmetric_uniform();
    (0..count)
        .map(|_| {
            let (x, y) = (uniform(1.5), uniform(1.5));
            let z = 0.2 * libm::sin(2.0 * x) * libm::cos(2.0 * y) + uniform(MANY_OFF);
            Contact::new(0, Point3::new(x, y, z), None)
        })
        .collect()
}

/// The patch of contacts that are seen from above.
///
/// # Errors
/// [`Ep2Error`] where they make none.
pub fn patch(contacts: &[Contact]) -> Result<Patch, Ep2Error> {
    Patch::new(contacts, &Vector3::z())
}

/// Places 30 × 30 on the sphere of few contacts, over the rectangle that holds those without error.
pub fn places_on_sphere() -> Vec<Point3<f64>> {
    let along = |index: usize, end: f64| end * (2.0 * (index as f64) / 29.0 - 1.0);
    let place = |index: usize| {
        let (x, y) = (along(index / 30, 1.5), along(index % 30, 1.0));
        Point3::new(x, y, (RADIUS * RADIUS - x * x - y * y).sqrt())
    };
    (0..900).map(place).collect()
}

/// Places 30 × 30 over the middle of many contacts, and the mean curvature there; negative on a peak seen from above
/// where the normal points up, so that it is turned round here: palpate counts a peak positive.
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

/// Root mean square error of the mean curvature of a fit to many contacts, 1/length.
///
/// # Errors
/// If the fit has no curvature at one of the points.
pub fn error_on_waves(fit: &Fit) -> Result<f64, Ep2Error> {
    let off = |(place, mean): (Point3<f64>, f64)| Ok(fit.curvature_at(&place)?.mean - mean);
    let errors: Result<Vec<f64>, Ep2Error> = places_on_waves().map(off).collect();
    errors.map(rms)
}

/// Fits of a method to contacts.
///
/// # Errors
/// Where the contacts make no patch.
pub fn fitted(
    name: &str,
    method: impl Method + 'static,
    contacts: &[Contact],
) -> Result<Evaluation> {
    let patch = patch(contacts)?;
    Ok(Evaluation::new(name, move || method.fit(black_box(&patch))))
}

/// Estimates of the penalised spline from contacts, without their uncertainty.
///
/// # Errors
/// Where the contacts make no patch.
pub fn estimated(name: &str, method: Penalised, contacts: &[Contact]) -> Result<Evaluation> {
    let patch = patch(contacts)?;
    Ok(Evaluation::new(name, move || {
        method.estimate(black_box(&patch))
    }))
}

/// Maps of a fit, this many places a side.
///
/// # Errors
/// Where the method cannot fit the contacts.
pub fn mapped(
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
