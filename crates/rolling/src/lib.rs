//! The forward law of a fingertip that rolls on a surface, or glides over it.
//!
//! Montana's contact equations (1988) describe how the contact moves over both bodies. This crate solves them with
//! several methods, the rungs of a ladder. A [`Roller`] uses the cheapest rung that meets a tolerance, or the rung that
//! is set:
//!
//! | rung | valid for | error, relative to the probe's radius |
//! |---|---|---|
//! | closed form | planes, spheres, dishes, cylinders; no spin | 1e-14 |
//! | meridian | surfaces of revolution through the apex, ellipsoids and saddles along their axes; no spin or sliding | 1e-13 |
//! | RK4 | all | compared with a finer integration when it is chosen |
//! | DOP853 | all | its tolerance, or as for RK4 |
//!
//! These errors are for one turn of the probe. They grow with the number of turns. If the bodies nearly conform, they
//! grow by the factor `(1/R₁ + |k|)/(1/R₁ + k)`, where k is the smallest curvature of the object. Rounding errors of
//! positions are relative to the object's size. Paths shorter than 1e-150 count as zero.
//!
//! The integrators use the chart-free equations by default, which have no poles, or Montana's equations in charts.
//!
//! Frames: the object is fixed. In the probe's contact frame, `x₁` and `y₁` are tangent and `z₁` points out of the
//! probe. It starts with `x₁` along the object's +x (projected onto the tangent plane) and is parallel-transported
//! along the path. At the first contact, the probe's body axes equal the object's.
//!
//! A [`Glider`] is a fingertip that slides instead of rolling: it computes the contact from the position of the finger.

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

pub use clearance::Terrain;
pub use contact::{Contact, Shift};
pub use contact_equations::{Chart, HeldAxis};
pub use error::{RollError, RollFault};
pub use glide::{Fingertip, GlideError, Glider, InvalidTouch, Touch, TouchModel};
pub use ladder_errors::MeasuredRung;
pub use model::{Choice, InvalidRoll, Model, Rolls, TOLERANCES};
pub use motion::Motion;
pub use roller::{Probe, Roller};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
