//! Nonlinear least squares of what a camera sees of a press.
//!
//! Each marker is made of two discs. A press moves them ([`Body`](crate::Body) at either depth), a camera sees them
//! ([`View`]), and the tracker reads centroid, hue and size of each marker ([`Seen`]). The frame at rest tells how the
//! discs of each marker are misaligned, and part of what is known only roughly of the sensor ([`Rest`]); the pressed
//! one, by the same law, where and how the sensor is touched. What is left unknown of the sensor is common to all
//! markers: it stands in the fit as parameters with their covariance, by which the interval is as wide as it must be.

mod descent;
mod doubts;
mod fitted;
mod frame;
mod known;
mod law;
mod learn;
mod mean;
mod minimise;
mod moved;
mod outcome;
mod pictures;
mod problem;
mod profile;
mod rest;
mod settings;
mod start;
mod told;
mod unknowns;
mod view;

pub use known::KnownPress;
pub use rest::Rest;
pub use settings::ImageFit;
pub use told::Told;
pub use view::{PictureSlopes, Seen, SensorState, Steps, View};
