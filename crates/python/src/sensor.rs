//! Sensors with markers: calibration, frames, layouts and patterns.

mod calibration;
mod camera;
mod frames;
mod layout;
mod reader;

pub(crate) use calibration::{Calibration, calibrate, calibrate_frames};
pub(crate) use camera::{CameraCalibration, calibrate_camera};

pub(crate) use frames::{Tracked, frame, pixels, track};
pub(crate) use layout::{Layout, Pattern, pattern, pattern_of};
