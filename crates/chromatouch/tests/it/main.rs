//! Integration tests of the spherical sensor.
#![allow(clippy::unwrap_used)]

mod pattern;
