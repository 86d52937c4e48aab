//! Frames of a camera that watches colour markers, to the markers' displacements. Knows nothing of how frames come about.

mod binned;
mod calibration;
mod camera;
mod coarse;
mod difference;
mod error;
mod errors;
mod field;
mod finder;
mod ground;
mod image_circle;
mod lighting;
mod marker;
mod matching;
mod measure;
mod odd_terms;
mod opening;
mod rim;
mod selection;
mod shapes;
mod sight;
mod split;
mod threshold;
mod window;

pub use calibration::{
    Calibration, CalibrationError, LateralCalibration, LateralPoint, Line, MarkerGain,
    NormalCalibration, NormalFrom, NormalPoint,
};
pub use camera::Equidistant;
pub use difference::{SizesDiffer, difference};
pub use error::TrackingError;
pub use errors::MarkerErrors;
pub use field::{Displaced, Field, FieldError, Outward};
pub use finder::{Finder, FinderSettings, Found};
pub use ground::Ground;
pub use image_circle::Mask;
pub use marker::{Change, Marker, Status, Track};
pub use matching::match_markers;
pub use sight::HueWindow;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
