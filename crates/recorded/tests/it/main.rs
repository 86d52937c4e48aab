//! Integration tests.
#![allow(clippy::unwrap_used)]

mod arrays;
mod camera_calibration;
mod consistency;
mod extreme_readings;
mod image_estimate;
mod reading_files;
