//! Geometry tests: laws for every surface, and closed forms for each one.
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
