//! Standard deviations of the reported values.

use nalgebra::Vector3;

use crate::state::State;
use crate::unknowns::{ACROSS, ALONG, CURVATURE, INDENTATION, Square, UNKNOWNS};
use crate::{Body, PressError, Skin};

/// Standard deviations of the reported values.
pub(crate) struct Stds {
    pub(crate) log_curvature: f64,
    pub(crate) indentation: f64,
    pub(crate) contact_radius: f64,
    pub(crate) contact: [f64; 2],
}

impl Stds {
    /// The standard deviations by the covariance of the unknowns, of which only the fitted ones are uncertain.
    pub(crate) fn new(
        (skin, body): (&Skin, &Body),
        state: &State,
        covariance: &Square,
        fitted: &[bool; UNKNOWNS],
    ) -> Result<Self, PressError> {
        let variance = |one: usize, other: usize| match fitted[one] && fitted[other] {
            true => covariance[(one, other)],
            false => 0.0,
        };
        let contact = state.contact(skin, body)?;
        let [_, slope] = body.indentation_of(contact.radius)?;
        // Variance of C D' a, with the contact's radius a and the indentation δ = C D(a): C D' da = dδ − δ d ln C.
        let indentation = state.indentation;
        let of_radius = variance(INDENTATION, INDENTATION)
            - 2.0 * indentation * variance(INDENTATION, CURVATURE)
            + indentation * indentation * variance(CURVATURE, CURVATURE);
        let share = 1.0 / (contact.relative_curvature * slope);
        // If the markers lie on a circle, the axes of the state's place are along and across the circle.
        let axes = skin.place_at(state.place.direction.as_ref());
        let along = |axis: &Vector3<f64>| {
            let (x, y) = (axis.dot(&state.place.x_axis), axis.dot(&state.place.y_axis));
            let squared = x * x * variance(ALONG, ALONG)
                + 2.0 * x * y * variance(ALONG, ACROSS)
                + y * y * variance(ACROSS, ACROSS);
            squared.max(0.0).sqrt()
        };
        Ok(Self {
            log_curvature: variance(CURVATURE, CURVATURE).sqrt(),
            indentation: variance(INDENTATION, INDENTATION).sqrt(),
            contact_radius: share * of_radius.max(0.0).sqrt(),
            contact: [along(&axes.x_axis), along(&axes.y_axis)],
        })
    }
}
