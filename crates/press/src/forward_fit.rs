//! Nonlinear least squares of a press's forward law.

mod bias;
mod doubts;
mod minimise;
mod misfit;
mod outcome;
mod presence;
mod problem;
mod profile;
mod reading;
mod search;
mod settings;
mod slip;
mod start;
mod unseen;

use crate::definite::inverse;
use crate::{Body, Contact, Markers, PressError, PressEstimate};
use outcome::Stds;
use problem::{Problem, State};
use search::{SINGULAR, Search};

pub use reading::{Measured, Reading};
pub use settings::{ForwardFit, Prior};

/// Cramér–Rao bounds on standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Bound for the relative curvature, and so for the object's curvature, 1/length.
    pub relative_curvature: f64,
    /// Bound for the indentation, length.
    pub indentation: f64,
    /// Bound for the contact's radius, length.
    pub contact_radius: f64,
}

impl ForwardFit {
    /// The press behind a reading. For a reading without error the likeliest curvature is that of the press within
    /// 1e-9, where the markers determine it.
    ///
    /// # Errors
    /// [`PressError::BadSetting`], [`PressError::NotFinite`], [`PressError::TooFewMarkers`] for what is given;
    /// [`PressError::NoContact`] where no marker moved beyond noise, or all moved alike; [`PressError::OtherBody`] where they moved otherwise than in any press of this body;
    /// [`PressError::OffMarkers`], [`PressError::Undetermined`] and those of [`Body::press`] where the readings fit no
    /// press.
    pub fn estimate(&self, reading: &Reading<'_>) -> Result<PressEstimate, PressError> {
        self.validate(reading)?;
        Search::new(self, reading)?.run()
    }

    /// The least standard deviations that an unbiased estimate can have (Cramér and Rao), for a true contact at chart
    /// coordinates `at`. `tangential` tells whether tangential displacements are sensed; `indentation_std` is the
    /// standard deviation of an indentation that is measured too, length.
    ///
    /// `None` without a stated noise, or where the readings do not determine the press.
    pub fn bounds(
        &self,
        markers: &Markers,
        contact: &Contact<'_>,
        at: [f64; 2],
        tangential: bool,
        indentation_std: Option<f64>,
    ) -> Option<Bounds> {
        let stated = |std: Option<f64>| std.filter(|&std| std > 0.0);
        let moved = markers.displacements(contact, at);
        let normal: Vec<f64> = moved.iter().map(|moved| moved.normal).collect();
        let along: Vec<[f64; 2]> = moved.iter().map(|moved| moved.tangential).collect();
        let value = contact.indentation;
        let reading = Reading {
            markers,
            normal: &normal,
            tangential: tangential.then_some(along.as_slice()),
            indentation: indentation_std.map(|std| Measured { value, std }),
        };
        let mut problem = Problem::new(self, &reading);
        problem.normal_std = stated(self.normal_std)?;
        if problem.uses_tangential() {
            problem.tangential_std = stated(self.tangential_std)?;
        }
        let place = problem.place_at(markers.skin().place(at).direction.as_ref());
        let state = State {
            log_curvature: libm::log(contact.relative_curvature),
            place,
            indentation: contact.indentation,
            baseline: 0.0,
            gain: 1.0,
        };
        problem.keep_window(&state);
        let covariance = inverse(&problem.sums(&state).ok()?.hessian, SINGULAR)?;
        let stds = Stds::new(&problem, &state, &covariance).ok()?;
        Some(Bounds {
            relative_curvature: stds.relative_curvature,
            indentation: stds.indentation,
            contact_radius: stds.contact_radius,
        })
    }
}

/// The c of the Gaussian approximation (R = c σ²/δ) that gives the sensor's own radius on a plane pressed by
/// `indentation` at the apex.
///
/// # Errors
/// [`PressError`] where the press or the fit of the Gaussian fails.
pub fn calibrated_c(
    markers: &Markers,
    body: &Body,
    indentation: f64,
    window: Option<f64>,
) -> Result<f64, PressError> {
    let plane = markers.skin().contact(body, 0.0, indentation)?;
    let moved = markers.displacements(&plane, [0.0; 2]);
    let normal: Vec<f64> = moved.iter().map(|moved| moved.normal).collect();
    let fit = ForwardFit {
        gain: Prior::Free,
        window,
        ..ForwardFit::new(Body::gaussian(1.0)?)
    };
    let found = fit.estimate(&Reading {
        markers,
        normal: &normal,
        tangential: None,
        indentation: Some(Measured {
            value: indentation,
            std: 0.0,
        }),
    })?;
    Ok(markers.skin().radius() * found.most_likely_curvature)
}
