//! Ways from tracked markers to what pressed them.

use palpate::Table;
use palpate::config::LengthUnit;
use palpate::recorded::{
    self, Frame, PictureOptions, PressGiven, PressOptions, RecordedError, Sensed, SensorOptions,
    TrackedFrames, TrackedPress, Wording, estimate_pictures,
};
use pyo3::prelude::*;

use super::calibration::Calibration;
use super::camera::CameraCalibration;
use crate::error;
use crate::estimate::like;
use crate::study::Study;

/// Way from tracked markers to what pressed them.
pub(super) enum Reader {
    /// By the displacements that a calibration tells.
    Displacements {
        calibration: Box<recorded::Calibration>,
        unit: LengthUnit,
        sensor: SensorOptions,
        options: Box<PressOptions>,
    },
    /// By what the camera of a study sees.
    Pictures(Box<PictureOptions>),
}

/// Displacements of the markers, and the press that they tell.
pub(super) struct Read {
    pub(super) readings: Table,
    pub(super) field: Table,
    pub(super) estimate: TrackedPress,
    pub(super) unit: LengthUnit,
}

fn refused(argument: &str, message: impl Into<String>) -> PyErr {
    error::argument(argument, &[], None, message)
}

impl Reader {
    /// The way that a call asks for, if it asks for one.
    pub(super) fn of(
        calibration: Option<&Bound<'_, PyAny>>,
        px_per_rad: Option<f64>,
        (study, cell): (Option<&Bound<'_, Study>>, usize),
        given: &PressGiven,
    ) -> PyResult<Option<Self>> {
        let config = like(study, cell, None, |config, _| Ok(config.clone()))?;
        let camera = calibration.and_then(|one| one.cast::<CameraCalibration>().ok());
        let other = calibration.and_then(|one| one.cast::<Calibration>().ok());
        if calibration.is_some() && camera.is_none() && other.is_none() {
            let message = "calibration: must be a Calibration or a CameraCalibration";
            return Err(refused("calibration", message));
        }
        if PictureOptions::are_asked_for(&given.estimator, config.as_ref()) {
            if other.is_some() {
                let message = "calibration: method=\"image\" takes a CameraCalibration, as calibrate_camera makes it";
                return Err(refused("calibration", message));
            }
            if px_per_rad.is_some() {
                let message = "px_per_rad is of no use to method=\"image\": like states the camera, or calibration does";
                return Err(refused("px_per_rad", message));
            }
            let camera = camera.map(|camera| camera.get().camera.clone());
            let unit = camera.as_ref().map(|camera| camera.length_unit);
            let base = like(study, cell, unit, palpate::study_options::pictures)?;
            let options = PictureOptions::given(given, base, Wording::Arguments);
            let mut options = options.map_err(error::given)?;
            options.camera = camera.map(|camera| ("calibration".to_owned(), camera));
            return Ok(Some(Self::Pictures(Box::new(options))));
        }
        if camera.is_some() {
            let message = "calibration: a CameraCalibration is of use only to method=\"image\"";
            return Err(refused("calibration", message));
        }
        let Some(calibration) = other else {
            return Ok(None);
        };
        let Calibration {
            calibration, unit, ..
        } = calibration.get();
        let base = like(study, cell, Some(*unit), palpate::study_options::press)?;
        let is_stated = base.is_some() || given.depth.is_some();
        let options = PressOptions::given(given, base, Wording::Arguments);
        let options = options.map_err(error::given)?;
        if !is_stated {
            return Err(refused("depth", "calibration needs depth, or like"));
        }
        Ok(Some(Self::Displacements {
            calibration: Box::new(calibration.clone()),
            unit: *unit,
            sensor: SensorOptions {
                radius: options.sensor_radius,
                depth: options.depth(),
                px_per_rad,
            },
            options: Box::new(options),
        }))
    }

    /// Reads markers, with a field of so many points along a side, smoothed so.
    pub(super) fn read(
        &self,
        frames: [&Frame; 2],
        tracked: &TrackedFrames,
        (grid, filter): (usize, f64),
    ) -> Result<Read, RecordedError> {
        match self {
            Self::Displacements {
                calibration,
                unit,
                sensor,
                options,
            } => {
                let sensed = Sensed::read(tracked, (calibration, *unit), sensor, None)?;
                Ok(Read {
                    field: sensed.field(grid, filter)?,
                    estimate: sensed.estimate(options)?,
                    readings: sensed.readings(),
                    unit: *unit,
                })
            }
            Self::Pictures(options) => {
                let pictured = estimate_pictures(frames, tracked, options, None)?;
                Ok(Read {
                    field: pictured.field(grid, filter)?,
                    estimate: pictured.press().clone(),
                    readings: pictured.readings(),
                    unit: options.unit(),
                })
            }
        }
    }
}
