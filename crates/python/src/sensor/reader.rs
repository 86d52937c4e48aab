//! Reads from the arguments of `track` how the press is estimated: with a calibration, or by a fit to the frames.

use palpate::recorded::{FrameReader, PictureOptions, PressOptions};
use pyo3::prelude::*;
use serde_json::{Map, Value as Json};

use super::calibration::Calibration;
use super::camera::CameraCalibration;
use crate::error;
use crate::estimate::like;
use crate::study::Study;

fn refused(argument: &str, message: impl Into<String>) -> PyErr {
    error::argument(argument, &[], None, message)
}

/// Chooses the method that estimates the press from the frames: a fit in the image, or a calibration of displacements.
/// Returns `None` if the arguments of `track` request no estimate.
pub(super) fn reader(
    calibration: Option<&Bound<'_, PyAny>>,
    px_per_rad: Option<f64>,
    (study, cell): (Option<&Bound<'_, Study>>, usize),
    given: &Map<String, Json>,
) -> PyResult<Option<FrameReader>> {
    let config = like(study, cell, None, |config, _| Ok(config.clone()))?;
    let camera = calibration.and_then(|one| one.cast::<CameraCalibration>().ok());
    let other = calibration.and_then(|one| one.cast::<Calibration>().ok());
    if calibration.is_some() && camera.is_none() && other.is_none() {
        let message = "calibration: must be a Calibration or a CameraCalibration";
        return Err(refused("calibration", message));
    }
    if PictureOptions::are_asked_for(given, config.as_ref()) {
        if other.is_some() {
            let message = "calibration: method=\"image\" needs a CameraCalibration, as \
                 calibrate_camera returns it";
            return Err(refused("calibration", message));
        }
        if px_per_rad.is_some() {
            let message = "px_per_rad has no effect with method=\"image\": like or calibration \
                 states the camera";
            return Err(refused("px_per_rad", message));
        }
        let camera = camera.map(|camera| camera.get().camera.clone());
        let unit = camera.as_ref().map(|camera| camera.length_unit);
        let base = like(study, cell, unit, PictureOptions::from_study)?;
        let options = PictureOptions::with_settings(base, given);
        let mut options = options.map_err(error::setting)?;
        options.camera = camera.map(|camera| ("calibration".to_owned(), camera));
        return Ok(Some(FrameReader::Pictures(Box::new(options))));
    }
    if camera.is_some() {
        let message = "calibration: a CameraCalibration has an effect only with method=\"image\"";
        return Err(refused("calibration", message));
    }
    let Some(calibration) = other else {
        return Ok(None);
    };
    let Calibration {
        calibration, unit, ..
    } = calibration.get();
    let base = like(study, cell, Some(*unit), palpate::press_options)?;
    let is_stated = base.is_some() || given.contains_key("depth");
    let options = PressOptions::with_settings(base, given, None, true).map_err(error::setting)?;
    if !is_stated {
        return Err(refused(
            "depth",
            "is missing: with a calibration, state `depth` or `like`",
        ));
    }
    Ok(Some(FrameReader::Displacements {
        calibration: Box::new(calibration.clone()),
        unit: *unit,
        px_per_rad,
        options: Box::new(options),
    }))
}
