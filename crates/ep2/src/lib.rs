//! EP2: the shape of a patch from fingers that slide over it.
//!
//! Fingers report where they touched and, if they can, the normals there ([`Contact`]). A
//! [`Patch`] holds them in a frame of its own, in which the patch is a graph w(u, v).
mod class;
mod contact;
mod curvature;
mod error;
mod fit;
mod frame;
mod knots;
mod noise;
mod patch;
mod penalised;
mod quadric;
mod regions;
mod smoothing;
mod spline;
mod square;
mod surface;
mod two_pass;

pub use contact::Contact;
pub use curvature::{Curvature, SignClass, Uncertainty};
pub use error::Ep2Error;
pub use fit::{Fit, Method};
pub use frame::PatchFrame;
pub use knots::{Basis, Knots, MAX_DEGREE};
pub use noise::{Noise, NoiseEstimate};
pub use patch::{Patch, Sample};
pub use penalised::{Criterion, Penalised};
pub use quadric::Quadric;
pub use regions::{Region, Regions, regions};
pub use smoothing::{Smoothed, SmoothingSpline, Status, WeightedPoint};
pub use spline::{Jet, TensorSpline};
pub use surface::MapPoint;
pub use two_pass::{Pass, Passes, TangentNormals, TwoPass, TwoPassFit};
