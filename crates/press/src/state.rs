//! The fit parameters of a press: relative curvature, place, indentation, and two parameters that depend on the kind of
//! fit.

use nalgebra::Vector3;

use crate::unknowns::{ACROSS, ALONG, CURVATURE, INDENTATION, OTHERS, Unknowns};
use crate::{Body, Contact, Place, PressError, Skin};

#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) log_curvature: f64,
    pub(crate) place: Place,
    pub(crate) indentation: f64,
    /// The two fit parameters that depend on the kind of fit. In a fit of displacements, they are the baseline (offset)
    /// and the gain. In a fit of images, they are the two components of the object's sideways shift.
    pub(crate) others: [f64; 2],
}

impl State {
    pub(crate) fn new(
        relative_curvature: f64,
        place: Place,
        indentation: f64,
        others: [f64; 2],
    ) -> Self {
        Self {
            log_curvature: libm::log(relative_curvature),
            place,
            indentation,
            others,
        }
    }

    pub(crate) fn contact<'b>(
        &self,
        skin: &Skin,
        body: &'b Body,
    ) -> Result<Contact<'b>, PressError> {
        skin.press(body, libm::exp(self.log_curvature), self.indentation)
    }

    /// The fit parameters after the step `step`. `place_at` converts a direction from the centre of the sensor to a
    /// place on its skin.
    pub(crate) fn stepped(
        &self,
        skin: &Skin,
        step: &Unknowns,
        place_at: impl Fn(&Vector3<f64>) -> Place,
    ) -> Self {
        let place = if step[ALONG] == 0.0 && step[ACROSS] == 0.0 {
            self.place
        } else {
            place_at(&skin.beyond(&self.place, step[ALONG], step[ACROSS]))
        };
        Self {
            log_curvature: self.log_curvature + step[CURVATURE],
            place,
            indentation: self.indentation + step[INDENTATION],
            others: [0, 1].map(|other| self.others[other] + step[OTHERS + other]),
        }
    }
}
