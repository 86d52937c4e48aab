//! Tests of the public face.
#![allow(clippy::unwrap_used)]

mod calibration;
mod field;
mod finder;
#[path = "../frames/mod.rs"]
mod frames;
mod matching;
