//! Noise and resolution of sensors that measure rotations, contact points and surface normals.
//!
//! The random numbers of a [`Stream`] depend only on seed, trial and [`Channel`]. Therefore every trial can be repeated
//! alone, and a new channel does not change the numbers of the existing channels.
//!
//! Displacements on the fingertip are great-circle displacements (logarithm map) from the first contact, in the tangent
//! basis at this contact; see [`displacement_between`].

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
pub use error::BeyondPads;
pub use pads::{PadLayout, PadOffset, PadPlacement, Pads};
pub use position::{MarkerNoise, PositionAxes, PositionError};
pub use rotation::{AngularVelocityError, Encoder};
pub use sphere_map::{direction_at, displacement_between};
pub use stream::Stream;
pub use surface_normal::NormalError;
pub use uniform_lattice::UniformLattice;
pub use wrist::Wrist;

/// A named source of noise. Each channel has its own stream of random numbers, so a new channel does not change the
/// numbers of the existing channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u64)]
pub enum Channel {
    /// Error of the angular velocity of a rolling probe.
    AngularVelocity = 1,
    /// Position of the first contact relative to the pads.
    PadOffset = 2,
    /// Error of the contact point that a force and torque sensor in the wrist infers.
    WristContact = 3,
    /// Error of a position that a fingertip sensor reports.
    Position = 4,
    /// Error of a surface normal that a fingertip sensor reports.
    Normal = 5,
    /// Error of a marker's displacement along the skin's normal.
    NormalDisplacement = 6,
    /// Error of a marker's displacement along the skin.
    TangentialDisplacement = 7,
    /// Error of an indentation that is measured independently of the skin's displacement.
    Indentation = 8,
    /// Error of the gain, that is, of the common factor of all normal displacements of a press.
    Gain = 9,
    /// Random choice of the markers with a wrong reading, and the errors of these readings.
    WrongMarkers = 10,
    /// Misalignment of a marker's two discs, which arises in manufacture.
    Misalignment = 11,
    /// Error of a pixel's intensity.
    Pixel = 12,
    /// Error of a marker's hue.
    Hue = 13,
    /// Error of a marker's centroid in the image.
    Centroid = 14,
    /// Error of a marker's size in the image.
    Size = 15,
    /// Random choice of the markers that are not found in the camera's frame.
    LostMarkers = 16,
    /// Deviation of a sensor's parameters from their nominal values.
    Sensor = 17,
    /// Random position between two encoder steps at which a roll starts, drawn for each roll.
    EncoderPhase = 18,
    /// Error of a measured rotation, drawn once for each roll.
    Rotation = 19,
    /// Error of a measured rotation, drawn once for each sample of a roll.
    RotationSample = 20,
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
