//! Integration tests of recorded readings.
#![allow(clippy::unwrap_used)]

mod arrays;
mod calibration_file;
mod camera_calibration;
mod extreme_readings;
mod frame_files;
mod image_estimate;
mod load_curve;
mod logs;
mod lost_rolls;
mod reading_files;
mod roll_series;
mod rotations;
mod table_files;
mod two_groups;
