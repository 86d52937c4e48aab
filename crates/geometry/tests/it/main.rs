//! Tests of the geometry: mathematical laws that hold for every surface, and exact formulas for each surface.
#![allow(clippy::unwrap_used)]

mod any_number;
mod closed_forms;
mod closest_points;
mod curvature;
mod extremes;
mod laws;
mod meridians;
mod refusals;
mod specimens;
