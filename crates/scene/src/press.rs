//! A press: a soft spherical sensor touches an object once. The curvature of the object is estimated from the
//! displacements of the markers under the skin.

mod camera_calibration;
mod camera_model;
mod description;
mod flawed_trial;
mod plan;
mod press_tables;
mod reading;
mod sensor_variation;
mod trial;
mod truth;

use palpate_chromatouch::OpticsError;
use palpate_press::PressError;
use palpate_tracking::TrackingError;
use strum::IntoStaticStr;
use thiserror::Error;

pub(crate) use camera_calibration::{CalibrationFrames, ImageChanges, RestFrames, RestMarkers};
pub use flawed_trial::PressFlaw;
pub use trial::PressScene;

/// Reason why a press or one of its trials has no estimate.
#[derive(Clone, Debug, Error, IntoStaticStr, PartialEq)]
pub enum PressFailure {
    /// The press is impossible, or no press fits its readings.
    #[error(transparent)]
    #[strum(transparent)]
    Press(#[from] PressError),
    /// The camera cannot image the displaced markers.
    #[error(transparent)]
    #[strum(transparent)]
    Optics(#[from] OpticsError),
    /// No markers were found in the camera's frame.
    #[error(transparent)]
    #[strum(transparent)]
    Camera(#[from] TrackingError),
}

impl PressFailure {
    /// Name of the failure for tables. It stays the same in all versions.
    pub(crate) fn name(&self) -> &'static str {
        self.into()
    }
}
