//! Tests of the public face.
#![allow(clippy::unwrap_used)]

mod calibration;
mod field;
