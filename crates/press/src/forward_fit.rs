//! Nonlinear least squares of a press's forward law.

use crate::{Body, Contact, Markers, PressError, PressEstimate};

/// What was read of one press.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    /// Where the markers lie.
    pub markers: &'a Markers,
    /// Inward displacement of each, length.
    pub normal: &'a [f64],
    /// Displacement of each along the skin, in the marker's axes, if it is sensed. Length.
    pub tangential: Option<&'a [[f64; 2]]>,
    /// The indentation, if something else tells it (a robot's pose).
    pub indentation: Option<Measured>,
}

/// A measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// Its standard deviation; 0 for exact.
    pub std: f64,
}

/// What is known of a nuisance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prior {
    /// It is as it should be.
    Exact,
    /// It is so within a standard deviation.
    Within(f64),
    /// Nothing is known: it is fitted.
    Free,
}

/// Least squares over relative curvature, place of the contact, indentation and what else is not known.
#[derive(Clone, Debug)]
pub struct ForwardFit {
    /// The forward law.
    pub body: Body,
    /// What all normal displacements are off by; should be 0. Length.
    pub baseline: Prior,
    /// Factor on all normal displacements; should be 1.
    pub gain: Prior,
    /// Standard deviation of normal displacements, length; found from the residuals if `None` or 0.
    pub normal_std: Option<f64>,
    /// The same of either tangential component.
    pub tangential_std: Option<f64>,
    /// Only markers within this distance of the contact count, length.
    pub window: Option<f64>,
}

/// Cramér–Rao bounds on standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Of the relative (and the object's) curvature, 1/length.
    pub relative_curvature: f64,
    /// Of the indentation, length.
    pub indentation: f64,
    /// Of the contact's radius, length.
    pub contact_radius: f64,
}

impl ForwardFit {
    /// A fit of a body, with nothing off and the noise to be found.
    pub const fn new(body: Body) -> Self {
        Self {
            body,
            baseline: Prior::Exact,
            gain: Prior::Exact,
            normal_std: None,
            tangential_std: None,
            window: None,
        }
    }

    /// The press behind a reading.
    ///
    /// # Errors
    /// [`PressError`].
    pub fn estimate(&self, reading: &Reading<'_>) -> Result<PressEstimate, PressError> {
        let _ = reading;
        Err(PressError::OutOfRange)
    }

    /// The least standard deviations that an unbiased estimate can have, for a true contact at chart coordinates.
    /// `tangential`: whether tangential displacements are sensed; `indentation_std`: of a known indentation.
    /// `None` without a stated noise, or where the readings do not determine the press.
    pub fn bounds(
        &self,
        markers: &Markers,
        contact: &Contact<'_>,
        at: [f64; 2],
        tangential: bool,
        indentation_std: Option<f64>,
    ) -> Option<Bounds> {
        let _ = (markers, contact, at, tangential, indentation_std);
        None
    }
}

/// The c of the Gaussian approximation (R = c σ²/δ) that gives the sensor's own radius on a plane pressed by `indentation`
/// at the apex.
///
/// # Errors
/// [`PressError`] where the press or the fit of the Gaussian fails.
pub fn calibrated_c(
    markers: &Markers,
    body: &Body,
    indentation: f64,
    window: Option<f64>,
) -> Result<f64, PressError> {
    let _ = (markers, body, indentation, window);
    Err(PressError::OutOfRange)
}
