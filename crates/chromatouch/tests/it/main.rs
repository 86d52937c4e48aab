//! Integration tests of the spherical sensor.
#![allow(clippy::unwrap_used)]

mod any_number;
mod frames;
mod layout;
mod mean_hue;
mod odd_lens;
mod optics;
mod optics_limits;
mod pattern;
mod pixel_noise;
mod pose;
mod slopes;
mod strain;
