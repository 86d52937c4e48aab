//! EP1: the curvature of an object at the contact, from a few small rolls of a spherical probe.
//!
//! The reading of a probe consists of its rotation, summed in the probe's contact frame, and the contact's shift on the
//! probe. Montana's equation relates rotation and shift by the relative curvature, the sum of the curvatures K₁ of the
//! probe and K₂ of the object:
//!
//! ```text
//! (Δp_u, Δp_v)ᵀ = (K₁ + K₂)⁻¹ (−Δθ_y, Δθ_x)ᵀ
//! ```
//!
//! The least-squares fit of Charlebois, Gupta and Payandeh (1996, equations 2 to 4) solves this equation for any number
//! of probes. See [`LeastSquares`].

mod batch;
mod crossings;
mod error;
mod estimate;
mod feasible_set;
mod least_squares;
mod linear_law;
mod misfit;
mod pad_edge;
mod reading;
mod roll_fit;
mod roll_series;
mod rolled_path;
mod series_estimate;
mod series_fit;
mod symmetric;

pub use batch::{BATCH_SIZE, BatchEstimates, BatchMoments, Moments, ProbeRotation};
pub use error::{Ep1Error, SeriesError};
pub use estimate::{Estimate, Measured};
pub use least_squares::LeastSquares;
pub use linear_law::rounding_std;
pub use palpate_statistics::{GoodnessOfFit, Misfit};
pub use reading::{PadStart, ProbeReading, ReadingNoise};
pub use roll_series::{PadCell, Places, RollSample, RollSeries, SeriesMethod, SeriesNoise};
pub use series_estimate::{Exclusion, Quantity, RollReport, SeriesEstimate};
pub use series_fit::estimate_series;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
