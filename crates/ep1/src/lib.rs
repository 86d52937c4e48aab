//! EP1: the curvature of an object at the contact, from a few small rolls of a spherical probe.
//!
//! Each probe gives the rotation summed in the probe's contact frame and the contact's shift on
//! the probe. Montana's equation relates them through the relative curvature,
//!
//! ```text
//! (Δp_u, Δp_v)ᵀ = (K₁ + K₂)⁻¹ (−Δθ_y, Δθ_x)ᵀ
//! ```
//!
//! which the least squares of the 1996 paper (equations 2 to 4) solve over any number of probes.
//! See [`LeastSquares`].

mod agreement;
mod doubt;
mod error;
mod estimate;
mod least_squares;
mod many;
mod moments;
mod reading;
mod sets;
mod symmetric;

pub use agreement::Agreement;
pub use doubt::Doubt;
pub use error::Ep1Error;
pub use estimate::{Estimate, Measured};
pub use least_squares::{LeastSquares, rounding_std};
pub use many::{MOST, ManyEstimates, ManyMoments};
pub use moments::{Moments, ProbeRotation};
pub use reading::{PadStart, ProbeReading, ReadingNoise};
pub use sets::{SetRow, Sets};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
