//! Integration tests of the sensor models.
#![allow(clippy::unwrap_used)]

mod any_number;
mod lattice;
mod normals;
mod pads;
mod stream;
mod surface_normal;
