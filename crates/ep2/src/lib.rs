//! EP2: the shape of a patch from fingers that slide over it.
//!
//! Fingers report where they touched and, if they can, the normals there ([`Contact`]). A
//! [`Patch`] holds them in a frame of its own, in which the patch is a graph w(u, v).
mod contact;
mod error;
mod fit;
mod frame;
mod knots;
mod patch;
mod spline;

pub use contact::Contact;
pub use error::Ep2Error;
pub use fit::{Fit, Method};
pub use frame::PatchFrame;
pub use knots::{Basis, Knots, MAX_DEGREE};
pub use patch::{Patch, Sample};
pub use spline::{Jet, TensorSpline};
