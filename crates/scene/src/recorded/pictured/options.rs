//! Options of a fit of frames.

use palpate_number::Number;
use palpate_study::config::{LengthUnit, PressConfig, PressEstimatorConfig, StudyConfig, in_unit};
use serde_json::{Map, Value as Json};

use super::super::camera_rest::{Meant, RestCamera, camera_of};
use super::super::like::{LikeError, factor, press_of};

/// Sensor before whose camera frames were taken, and what else is known of the press.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureOptions {
    /// The press as a study states it, in the unit of all lengths.
    pub(in crate::recorded) press: PressConfig,
    pub(in crate::recorded) unit: LengthUnit,
    /// The indentation, if something else tells it, length: as
    /// [`PressOptions::indentation`](super::super::PressOptions::indentation).
    pub indentation: Option<f64>,
    /// Young's modulus of the soft body, force per length²; gives forces.
    pub young: Option<f64>,
    /// The camera as a frame at rest told it, with the name of its file, for messages; `None` where it is the study's. Discs
    /// are then known as [`calibrate_camera`](super::super::calibrate_camera) takes them to be, and what the frame at rest
    /// says of the camera once more is left out, for it may be the frame that told it.
    pub camera: Option<(String, RestCamera)>,
}

impl PictureOptions {
    /// Options with layout, discs, body, camera and noise of a study, lengths converted to `unit`. The indentation of the
    /// study's presses is not that of the frames.
    ///
    /// # Errors
    /// [`LikeError`] for a scene that is no press before a camera, a unit that cannot be converted, and markers that are no
    /// discs.
    pub fn like(study: &StudyConfig, unit: LengthUnit) -> Result<Self, LikeError> {
        let press = in_unit(press_of(study)?, factor(study, unit)?);
        Meant::of(&press, camera_of(&press)?)?;
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
    pub(in crate::recorded) fn thickness(&self) -> Option<f64> {
        crate::press::thickness(&self.press.estimator, &self.press.model)
    }

    /// Warning that the body that is fitted is not that of the study's model, which has a layer.
    pub(super) fn other_body(&self) -> Option<String> {
        let layer = self.press.model.thickness()?;
        self.thickness().is_none().then(|| {
            format!(
                "a half-space is fitted, since Poisson's ratio is given without a thickness, though the study's model is a layer of {} {}",
                Number(layer),
                self.unit().as_str()
            )
        })
    }

    /// Poisson's ratio of a body without a layer.
    pub(in crate::recorded) fn poisson(&self) -> f64 {
        let own = match self.press.estimator {
            PressEstimatorConfig::Image { poisson, .. } => poisson,
            _ => None,
        };
        own.unwrap_or(self.press.model.poisson())
    }

    /// Whether readings are estimated from by pictures: by the settings that are given, else by a study's estimator.
    pub fn are_asked_for(given: &Map<String, Json>, study: Option<&StudyConfig>) -> bool {
        let of_study = || Some(press_of(study?).ok()?.estimator.name());
        let kind = given.get("kind").and_then(Json::as_str).or_else(of_study);
        kind == Some("image")
    }
}
