//! Integration tests of rolls and glides.
#![allow(clippy::unwrap_used)]

mod any_number;
mod auto;
mod clearance;
mod endings;
mod extremes;
mod glide;
mod golden;
mod rungs;
mod scenes;
mod touch_models;
