//! Tests of the public face.
#![allow(clippy::unwrap_used)]

mod any_number;
mod calibration;
mod extremes;
mod field;
mod finder;
#[path = "../frames/mod.rs"]
mod frames;
mod matching;
