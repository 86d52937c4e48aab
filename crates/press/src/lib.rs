//! Elastic contact of a soft spherical fingertip: what one press does to its skin, and what the skin's displacements
//! tell of the object.
//!
//! Forward, from a relative curvature and an indentation to displacements at the markers: [`Body`] (Hertz contact at
//! the surface, half-space at depth, layer bonded to a rigid core), [`Skin`] and [`Markers`]. Back, from displacements
//! to the curvature: [`ForwardFit`].

mod body;
mod bonded_layer;
mod definite;
mod doubt;
mod error;
mod estimate;
mod field;
mod forward_fit;
mod half_space;
pub mod hertz;
mod image_fit;
mod markers;
mod press_slopes;
mod regime;
mod score;
pub mod shear;
mod skin;
mod spheroidal;
mod unexplained;

pub use body::{Body, Contact, Displacement};
pub use bonded_layer::{BondedLayer, LayerContact};
pub use doubt::Doubt;
pub use error::PressError;
pub use estimate::{Estimated, Interval, PressEstimate, Verdict};
pub use field::Field;
pub use forward_fit::{Bounds, ForwardFit, Measured, Prior, Reading, calibrated_c};
pub use image_fit::{
    ImageFit, KnownPress, PictureSlopes, Rest, Seen, SensorState, Steps, Told, View,
};
pub use markers::{MarkerDisplacement, Markers};
pub use palpate_statistics::GoodnessOfFit;
pub use regime::ContactRegime;
pub use skin::{Place, Skin, within_object};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
