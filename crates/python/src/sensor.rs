//! Sensors with markers: calibration, frames, layouts and patterns.

mod calibration;
mod camera;
mod cut;
mod frames;
mod layout;
mod reader;

pub(crate) use calibration::{Calibration, calibrate, calibrate_frames};
pub(crate) use camera::{CameraCalibration, calibrate_camera};
pub(crate) use cut::{Pattern, pattern_of};
pub(crate) use frames::{Tracked, track};
pub(crate) use layout::{Layout, pattern};
