//! Nonlinear least-squares fit of a press model to the camera image of the markers.
//!
//! Each marker consists of two discs, a magenta and a yellow one, at two depths. A press displaces the discs; one
//! [`Body`] per depth computes the displacements. A camera takes an image ([`View`]), and the tracker measures the
//! centroid, hue and size of each marker ([`Seen`]).
//!
//! Two frames are used. The frame at rest determines the misalignment between the two discs of each marker ([`Rest`]).
//! It also determines some of the sensor deviations, which are differences between the sensor's parameters and their
//! nominal values, common to all markers. The pressed frame determines the contact. Sensor deviations that remain
//! uncertain are parameters of the fit with a known covariance. The interval of the curvature therefore includes their
//! uncertainty.

mod curvature_posterior;
mod departure_prior;
mod descent;
mod disc_displacements;
mod fit_state;
mod image_check;
mod image_problem;
mod image_search;
mod residual_displacement;
mod rest;
mod sensor_update;
mod view;

pub use departure_prior::DeparturePrior;
pub use rest::Rest;
pub use view::{PictureSlopes, Seen, SensorState, Steps, View};

use std::sync::Arc;

use crate::{Body, Markers, Measured, PressError};
use departure_prior::FreePrior;

/// A least-squares fit of the images of one press. The fitted parameters are the relative curvature, the place of the
/// contact, the indentation and, if possible, the sideways shift of the object.
#[derive(Clone, Debug)]
pub struct ImageFit {
    /// The camera model, which computes the image of the markers after their discs were displaced.
    pub view: Arc<dyn View>,
    /// The markers, that is, their places on the skin.
    pub markers: Markers,
    /// The soft body, as two models: the first computes displacements at the depth of the magenta discs, the second at
    /// the depth of the yellow discs.
    pub bodies: [Body; 2],
    /// A small length, and the two bodies (one per disc colour) for discs that are deeper by this length. From these
    /// bodies the fit computes derivatives with respect to the depths of the discs. The field is required if the depths
    /// are uncertain.
    pub deeper: Option<(f64, [Body; 2])>,
    /// Prior standard deviations of the sensor's parameters, in the order and the units of [`SensorState::common`]. The
    /// value 0 means that a sensor parameter is exactly equal to its nominal value.
    pub common_stds: Vec<f64>,
    /// Joint normal prior of some of the sensor deviations (differences between the sensor's parameters and their
    /// nominal values); `None` if all sensor deviations have independent priors with the standard deviations
    /// `common_stds`.
    pub departure_prior: Option<DeparturePrior>,
    /// Standard deviation (rad) of each component of the misalignment between a marker's two discs; 0 if the discs are
    /// aligned.
    pub misalignment_std: f64,
    /// Standard deviation (length) of each component of a sideways shift of the object after the first contact. It is 0
    /// if the object does not shift. Only half-spaces have a model of shifts.
    pub shift_std: f64,
}

impl ImageFit {
    fn validate(&self) -> Result<(), PressError> {
        for std in &self.common_stds {
            squarable("common_stds", *std)?;
        }
        squarable("misalignment_std", self.misalignment_std)?;
        squarable("shift_std", self.shift_std)?;
        self.known()?;
        if let Some((deeper, _)) = self.deeper {
            let good = deeper > 0.0 && deeper <= 1e50;
            PressError::unless_good("deeper", deeper, good, "> 0 and at most 1e50")?;
        }
        Ok(())
    }

    fn check(
        &self,
        rest: &Rest,
        seen: &[Option<Seen>],
        indentation: Option<Measured>,
    ) -> Result<(), PressError> {
        self.validate()?;
        let markers = self.markers.places().len();
        for given in [seen.len(), rest.seen.len()] {
            let good = given == markers;
            PressError::unless_good("readings", given as f64, good, "one for each marker")?;
        }
        let departures = rest.information.nrows();
        let expected = "as many departures that are not exact as the fit has";
        let good = departures == self.free().len();
        PressError::unless_good("rest", departures as f64, good, expected)?;
        for (marker, seen) in seen.iter().enumerate() {
            if let Some(seen) = seen {
                seen.check(marker)?;
            }
        }
        indentation.map_or(Ok(()), Measured::check)
    }

    fn known(&self) -> Result<Option<FreePrior>, PressError> {
        let prior = self.departure_prior.as_ref();
        prior
            .map(|prior| prior.of_free(&self.common_stds))
            .transpose()
    }

    /// Indices and prior standard deviations of the uncertain sensor parameters. Parameters with the standard deviation
    /// 0 are exact, and are left out.
    fn free_stds(&self) -> Vec<(usize, f64)> {
        let stds = self.common_stds.iter().copied().enumerate();
        stds.filter(|(_, std)| *std > 0.0).collect()
    }

    fn free(&self) -> Vec<usize> {
        let free = self.free_stds().into_iter();
        free.map(|(number, _)| number).collect()
    }
}

fn squarable(setting: &'static str, std: f64) -> Result<(), PressError> {
    let good = std == 0.0 || (1e-100..=1e100).contains(&std);
    PressError::unless_good(setting, std, good, "0 or from 1e-100 to 1e100").map(|_| ())
}
