//! The forward law of a fingertip that rolls on a surface, or glides over it.
//!
//! Montana's contact equations (1988) say how the contact moves over both bodies. Here they stand
//! on a ladder of rungs, cheapest first, of which a [`Roller`] takes the cheapest that meets a
//! tolerance, or the one it is told to:
//!
//! | rung | valid for | error, relative to the probe's radius |
//! |---|---|---|
//! | closed form | planes, spheres, dishes, cylinders; no spin | 1e-14 |
//! | meridian | surfaces of revolution, through the apex; no spin or sliding | 1e-13 |
//! | RK4 | all | measured against a finer integration when it is chosen |
//! | DOP853 | all | its tolerance, or measured like RK4's |
//!
//! These are errors over a turn of the probe; they grow with the number of turns, and by
//! `(1/R₁ + |k|)/(1/R₁ + k)` where the least curvature k of the object nearly makes the bodies conform.
//! Positions have no more digits than coordinates of the object's size. Paths shorter than 1e-150 count as
//! none.
//!
//! The integrators work chart-free by default, which has no poles, or in Montana's chart form.
//!
//! Frames: the object stands still. The probe's contact frame has `x₁`, `y₁` tangent and `z₁` out
//! of the probe; it starts with `x₁` along the object's +x (projected onto the tangent plane) and
//! is parallel-transported along the path. The probe's body axes equal the object's at the first
//! contact.
//!
//! A [`Glider`] is a fingertip that slides instead: where it touches when held above a place.

mod bodies;
mod chart;
mod chart_free;
mod clearance;
mod closed_form;
mod contact;
mod error;
mod form;
mod glide;
mod integration;
pub mod integrator;
mod ladder;
mod measured;
mod meridian;
mod model;
mod motion;
mod roller;
mod rung;

pub use bodies::Probe;
pub use clearance::Terrain;
pub use contact::{Contact, Shift};
pub use error::{RollError, RollFault};
pub use form::{Chart, HeldAxis};
pub use glide::{Fingertip, GlideError, Glider, InvalidTouch, Touch, TouchModel};
pub use measured::MeasuredRung;
pub use model::{Choice, InvalidRoll, Model, Rolls, TOLERANCES};
pub use motion::Motion;
pub use roller::Roller;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
