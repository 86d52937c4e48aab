//! EP2: estimates the shape of a surface patch from fingers that slide over it.
//!
//! Fingers report their contact points and, if their sensors can measure them, the normals at these points
//! ([`Contact`]). A [`Patch`] stores the contacts in its own frame, in which the patch is a graph w(u, v). Therefore
//! its position, orientation and size do not affect the result. A [`Method`] fits a surface to the patch:
//!
//! | method | fitted surface | standard errors |
//! |---|---|---|
//! | [`Quadric`] | one quadric, by weighted least squares; biased on all other surfaces | due to noise only |
//! | [`TwoPass`] | two smoothing splines, as in the 1996 paper; the second is fitted to points of the first and of its tangents | none |
//! | [`Penalised`] | one spline; the smoothing is selected from the heights and slopes of the contacts | due to noise and to the bias of the smoothing |
//!
//! [`ShapeSettings`] fits a plane, a sphere or a cylinder to contacts on any side of an object. It chooses the most
//! probable shape and leaves out gross outliers ([`SoundContacts`]). [`IndependentFit`] fits a surface to a log whose
//! contacts are not independent ([`EffectiveReadings`]). [`stroke_curvature`] computes the curvature along a single
//! stroke.
//!
//! [`RoundTip`] computes the contacts of round fingertips from their centres or their lowest points.
//!
//! From a [`Fit`], the following can be computed: Gaussian and mean curvature at any place ([`Fit::curvature_at`]),
//! principal curvatures and directions on a map ([`Fit::map`]), the probability of each of the eight shape classes
//! ([`Curvature::class_probabilities`]), and connected [`regions`] of one class. Curvature is positive where the object
//! is convex. Its unit is the inverse of the contacts' length unit.
//!
//! ```
//! use nalgebra::{Point3, Vector3};
//! use palpate_ep2::{Contact, Method, Patch, Penalised};
//!
//! // Three fingers slide over a ball of radius 5.
//! let mut contacts = Vec::new();
//! for finger in 0..3 {
//!     for step in 0..10 {
//!         let (x, y) = (step as f64 / 3.0 - 1.5, 1.5 * (finger as f64 - 1.0));
//!         let from_centre = Vector3::new(x, y, (25.0 - x * x - y * y).sqrt());
//!         contacts.push(Contact::new(finger, Point3::from(from_centre), Some(from_centre)));
//!     }
//! }
//! let patch = Patch::new(&contacts, &Vector3::z())?;
//! let centre = Penalised::default().fit(&patch)?.centre()?;
//! assert!((centre.curvature.mean - 0.2).abs() < 0.01);
//! # Ok::<(), palpate_ep2::Ep2Error>(())
//! ```

mod chebyshev;
mod class;
mod curvature;
mod effective_readings;
mod error;
mod fit;
mod frame;
mod gross_outliers;
mod independent_fit;
mod knots;
mod matrix;
mod misfit;
mod noise;
mod patch;
mod penalised;
mod posterior;
mod primitive;
mod quadric;
mod regions;
mod smoothing;
mod spline;
mod square_quadric;
mod stroke;
mod surface_outliers;
mod tip;
mod two_pass;

pub use class::SignClass;
pub use curvature::{Curvature, Uncertainty};
pub use effective_readings::{DistinctContacts, EffectiveReadings};
pub use error::Ep2Error;
pub use fit::{Fit, MapPoint, Method};
pub use frame::PatchFrame;
pub use gross_outliers::{Outlier, OutlierReason, SoundContacts};
pub use independent_fit::IndependentFit;
pub use misfit::MisfitTest;
pub use noise::{Noise, NoiseEstimate};
pub use palpate_statistics::{GoodnessOfFit, Misfit};
pub use patch::{Contact, Patch, Sample};
pub use penalised::{Criterion, Penalised};
pub use primitive::{Shape, ShapeError, ShapeFit, ShapeSettings, SizeEstimate};
pub use quadric::Quadric;
pub use regions::{Region, Regions, regions};
pub use smoothing::Status;
pub use stroke::{StrokeCurvature, stroke_curvature};
pub use tip::{RoundTip, TipPoint};
pub use two_pass::{Passes, TangentNormals, TwoPass};

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    mod fitpack;
    mod smoothing;
    mod two_pass;
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
