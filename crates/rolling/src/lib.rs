//! Computes the contact of a fingertip that rolls on a surface or glides over it.
//!
//! Montana's contact equations (1988) describe how the contact moves over both bodies. This crate solves them with
//! several models. A [`Roller`] uses the cheapest model that meets a tolerance, or the model that the user states:
//!
//! | model | valid for | error, relative to the displacement of the contact per radian |
//! |---|---|---|
//! | closed form | planes, spheres, dishes, cylinders; no spin | 1e-14 |
//! | meridian | surfaces of revolution through the apex; ellipsoids, saddles and symmetric formulas along their axes; no spin or sliding | 1e-13 |
//! | RK4 | all rolls | measured against a finer integration when the model is chosen |
//! | DOP853 | all rolls | its tolerance, or measured as for RK4 |
//!
//! These errors are for one turn of the probe. The errors grow with the number of turns. If the bodies nearly conform,
//! the errors are larger by the factor `(1/R₁ + |k|)/(1/R₁ + k)`. Here R₁ is the radius of the probe, and k is the
//! smallest curvature of the object. Rounding errors of positions are relative to the object's size. Paths shorter than
//! 1e-150 count as zero.
//!
//! By default, the integrators RK4 and DOP853 use equations without charts, which have no poles. They can also use
//! Montana's equations in charts.
//!
//! The object is fixed. In the contact frame of the probe, `x₁` and `y₁` are tangents and `z₁` points out of the probe.
//! At the start, `x₁` is the projection of the object's +x axis onto the tangent plane. The frame is
//! parallel-transported along the path. At the first contact, the body axes of the probe are equal to those of the
//! object.
//!
//! A [`Glider`] is a fingertip that slides instead of rolling. It computes the contact from the position of the finger.

mod chart;
mod chart_free;
mod clearance;
mod closed_form;
mod contact;
mod contact_equations;
mod error;
mod glide;
mod integration;
mod integrator;
mod ladder;
mod ladder_errors;
mod meridian;
mod model;
mod motion;
mod roller;
mod sampled_path;

pub use clearance::Terrain;
pub use contact::{Contact, Shift};
pub use contact_equations::{Chart, HeldAxis};
pub use error::{RollError, RollFault};
pub use glide::{Fingertip, GlideError, Glider, InvalidTouch, Touch, TouchModel};
pub use ladder_errors::MeasuredRung;
pub use model::{Choice, InvalidRoll, Model, Rolls, TOLERANCES};
pub use motion::Motion;
pub use roller::Roller;
pub use sampled_path::PathPoint;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
