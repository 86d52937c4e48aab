//! Noise and resolution of sensors for rotations and points.
//!
//! Random numbers are keyed: a [`Stream`] is a function of seed, trial and [`Channel`]. So every trial can be repeated
//! alone, and a new channel does not change the numbers of other channels.
//!
//! Displacements on the fingertip are great-circle displacements (logarithm map) from the first
//! contact, in the tangent basis there; see [`displacement_between`].

mod distribution;
mod error;
mod normal_deviates;
mod pads;
mod position;
mod rotation;
mod sphere_map;
mod stream;
mod surface_normal;
mod uniform_lattice;
mod wrist;

pub use distribution::{Distribution, GaussianError};
pub use error::{BeyondPads, InvalidSensor};
pub use pads::{PadLayout, PadOffset, PadPlacement, Pads};
pub use position::{PositionAxes, PositionError};
pub use rotation::{AngularVelocityError, Encoder};
pub use sphere_map::{direction_at, displacement_between};
pub use stream::{Channel, Stream, Streams};
pub use surface_normal::NormalError;
pub use uniform_lattice::UniformLattice;
pub use wrist::Wrist;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
