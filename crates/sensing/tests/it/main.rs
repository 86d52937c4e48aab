//! Integration tests of the sensors.
#![allow(clippy::unwrap_used)]

mod lattice;
mod pads;
