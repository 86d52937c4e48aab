//! Models the elastic contact of a soft spherical fingertip with an object. Computes the displacements of the
//! fingertip's skin in a press, and estimates the curvature of the object from these displacements.
//!
//! [`Body`], [`Skin`] and [`Markers`] compute the displacements of the markers from the relative curvature and the
//! indentation. The body is a half-space or a layer that is bonded to a rigid core. The markers may be at the surface
//! or deeper. [`ForwardFit`] estimates the curvature from displacements of the markers. [`ImageFit`] estimates it from
//! images of the markers.

mod body;
mod bonded_layer;
mod elliptic_contact;
mod elliptic_fit;
mod error;
mod estimate;
mod forward_fit;
mod half_space;
mod image_fit;
mod least_squares;
mod markers;
mod misfit;
mod object_press;
mod outcome;
mod profile;
mod regime;
mod shear;
mod skin;
mod unknowns;

pub use body::{Body, Contact, Displacement};
pub use elliptic_contact::EllipticContact;
pub use error::PressError;
pub use estimate::{Estimated, Interval, PressEstimate, PrincipalCurvatures, Verdict};
pub use forward_fit::{Bounds, ForwardFit, Measured, Prior, Reading, calibrated_c};
pub use image_fit::{
    DeparturePrior, ImageFit, PictureSlopes, Rest, Seen, SensorState, Steps, View,
};
pub use markers::{MarkerDisplacement, Markers, skin_widening};
pub use object_press::{ObjectContact, ObjectPress};
pub use palpate_statistics::{GoodnessOfFit, Misfit};
pub use regime::{ContactRegime, sneddon_indentation};
use skin::Place;
pub use skin::Skin;

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    mod bonded_layer;
    mod shear;
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
