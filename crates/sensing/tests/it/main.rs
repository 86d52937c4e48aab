//! Integration tests of the sensors.
#![allow(clippy::unwrap_used)]

mod every_number;
mod extremes;
mod lattice;
mod normals;
mod pads;
