//! Integration tests.
#![allow(clippy::unwrap_used)]

mod arrays;
mod camera_calibration;
mod extreme_readings;
mod image_estimate;
mod load_curve;
mod reading_files;
