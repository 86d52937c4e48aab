//! Frames of a camera that watches colour markers, to the markers' displacements. Knows nothing of how frames come about.

mod calibration;
mod camera;
mod marker;

pub use calibration::{
    Calibration, CalibrationError, LateralCalibration, LateralPoint, Line, MarkerGain,
    NormalCalibration, NormalFrom, NormalPoint, Shown,
};
pub use camera::Equidistant;
pub use marker::{Change, Marker, Status, Track};
