//! Sensors as they are: noise and resolution as channels over rotations and points.
//!
//! Randomness is keyed: a [`Stream`] is a function of seed, trial and [`Channel`], so that any
//! trial can be replayed alone, and adding a channel changes no other number.
//!
//! Displacements on the fingertip are great-circle displacements (logarithm map) from the first
//! contact, in the tangent basis there; see [`displacement_between`].

mod angular_velocity;
mod distribution;
mod encoder;
mod error;
mod gaussian;
mod normal;
mod normals;
mod pads;
mod position;
mod sphere_map;
mod stream;
mod uniform_lattice;
mod wrist;

pub use angular_velocity::AngularVelocityError;
pub use distribution::Distribution;
pub use encoder::Encoder;
pub use error::{BeyondPads, InvalidSensor};
pub use gaussian::GaussianError;
pub use normal::NormalError;
pub use pads::{PadLayout, PadOffset, PadPlacement, Pads};
pub use position::{PositionAxes, PositionError};
pub use sphere_map::{direction_at, displacement_between};
pub use stream::{Channel, Stream, Streams};
pub use uniform_lattice::UniformLattice;
pub use wrist::Wrist;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
