//! The laws of geometry, run on every surface, and the closed forms each one must reach.
#![allow(clippy::unwrap_used)]

mod any_number;
mod closed_forms;
mod closest_points;
mod extremes;
mod laws;
mod meridians;
mod refusals;
mod scaling;
mod specimens;
