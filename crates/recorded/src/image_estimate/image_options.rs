//! Options of a fit of frames.

use palpate_statistics::Number;
use palpate_study::config::{LengthUnit, PressConfig, PressEstimatorConfig, StudyConfig, in_unit};
use serde_json::{Map, Value as Json};

use super::super::camera_calibration::{CameraEstimate, NominalSensor, camera_of};
use super::super::study_options::{StudyMismatch, factor, press_of};

/// The camera sensor that took the frames, and the stated data of the press.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureOptions {
    /// The press of the study, with its lengths converted to `unit`.
    pub(crate) press: PressConfig,
    pub(crate) unit: LengthUnit,
    /// The indentation, if it is measured otherwise, length: see
    /// [`PressOptions::indentation`](super::super::PressOptions::indentation).
    pub indentation: Option<f64>,
    /// Young's modulus of the soft body, force per length²; needed for forces.
    pub young: Option<f64>,
    /// The camera calibrated from a frame at rest, with its file's name for messages; `None` uses the study's camera.
    /// With a calibration, discs have the uncertainty that [`calibrate_camera`](super::super::calibrate_camera)
    /// assumes, and the frame at rest does not refine the camera, because it may be the frame of the calibration.
    pub camera: Option<(String, CameraEstimate)>,
}

impl PictureOptions {
    /// Options with layout, discs, body, camera and noise of a study, lengths converted to `unit`. The study's
    /// indentation is not used.
    ///
    /// # Errors
    /// [`StudyMismatch`] if the scene is not a press with a camera, the unit cannot be converted, or the markers are not
    /// discs.
    pub fn from_study(study: &StudyConfig, unit: LengthUnit) -> Result<Self, StudyMismatch> {
        let press = in_unit(press_of(study)?, factor(study, unit)?);
        NominalSensor::of(&press, camera_of(&press)?)?;
        Ok(Self {
            press,
            unit,
            indentation: None,
            young: None,
            camera: None,
        })
    }

    /// Unit of all lengths.
    pub const fn unit(&self) -> LengthUnit {
        self.unit
    }

    /// Thickness of the layer, if the body has one.
    pub(crate) fn thickness(&self) -> Option<f64> {
        self.press.estimator.layer(self.press.model.thickness())
    }

    /// Warning if a half-space is fitted although the study's model is a layer.
    pub(super) fn other_body(&self) -> Option<String> {
        let layer = self.press.model.thickness()?;
        self.thickness().is_none().then(|| {
            format!(
                "a half-space is fitted, because Poisson's ratio is given without a thickness, but the study's model is a layer of {} {}",
                Number(layer),
                self.unit().as_str()
            )
        })
    }

    /// Poisson's ratio of a body without a layer.
    pub(crate) fn poisson(&self) -> f64 {
        let own = match self.press.estimator {
            PressEstimatorConfig::Image { poisson, .. } => poisson,
            _ => None,
        };
        own.unwrap_or(self.press.model.poisson())
    }

    /// Whether the method is `image`, by the given settings or else by the study's estimator.
    pub fn are_asked_for(given: &Map<String, Json>, study: Option<&StudyConfig>) -> bool {
        let of_study = || Some(press_of(study?).ok()?.estimator.name());
        let kind = given.get("kind").and_then(Json::as_str).or_else(of_study);
        kind == Some("image")
    }
}
