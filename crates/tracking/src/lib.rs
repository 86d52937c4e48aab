//! Finds colour markers in camera frames, and converts the changes of the markers between two frames to displacements.
//! The frames may be simulated or recorded.

mod binning;
mod calibration;
mod camera;
mod difference;
mod error;
mod field;
mod finder;
mod ground_mask;
mod image_circle;
mod lighting;
mod marker;
mod marker_features;
mod matching;
mod measure;
mod opening;
mod selection;
mod shapes;

pub use calibration::{
    Calibration, CalibrationError, CalibrationPoint, LateralCalibration, LateralPoint, Line,
    MarkerGain, NormalCalibration, NormalFrom, NormalPoint,
};
pub use camera::Equidistant;
pub use difference::difference;
pub use error::TrackingError;
pub use field::{Displaced, Field, FieldError};
pub use finder::{Finder, Found};
pub use ground_mask::Ground;
pub use image_circle::Mask;
pub use marker::{Change, Marker, Status, Track};
pub use marker_features::MarkerErrors;
pub use matching::match_markers;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
