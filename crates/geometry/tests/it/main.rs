//! The laws of geometry, run on every surface, and the closed forms each one must reach.
#![allow(clippy::unwrap_used)]

mod closed_forms;
mod closest_points;
mod every_number;
mod extremes;
mod laws;
mod meridians;
mod scaling;
mod specimens;
