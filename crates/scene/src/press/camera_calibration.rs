//! Calibration of a camera sensor. It needs frames at rest, and presses on a plane.

use std::sync::Arc;

use palpate_chromatouch::MarkerMotion;
use palpate_press::{MarkerDisplacement, ObjectPress, PressError};
use palpate_statistics::Number;
use palpate_study::FieldError;
use palpate_study::config::{self, CalibrationConfig, CameraConfig, ShownMarkers};
use palpate_tracking::{Calibration, CalibrationPoint, Change, Marker, NormalFrom};

use super::PressFailure;
use super::camera_model::{AT_REST, MarkerMeasurement, SimulatedCamera};
use super::plan::PressSetup;
use super::truth::DiscMarkers;

const PATH: &str = "scene.sensor.calibration";

#[derive(Clone, Debug)]
pub(super) struct CameraCalibration {
    pub(super) calibration: Calibration,
    /// Standard deviations of the errors that the calibration causes near a contact: first the error of normal
    /// displacements, then the error of tangential displacements. `None` for a standard deviation that is 0 or cannot
    /// be computed.
    pub(super) stds: [Option<f64>; 2],
}

impl CameraCalibration {
    /// Calibrates a sensor with simulated presses of its apex on a plane. It compares the markers' images in these
    /// presses with their true displacements. `rest` contains the images of the markers at rest.
    pub(super) fn new(
        setup: &PressSetup<'_>,
        config: &CameraConfig,
        discs: &DiscMarkers<'_>,
        frames: &RestFrames,
        rest: &[Option<Marker>],
    ) -> Result<Self, FieldError> {
        let planes = planes(&config.calibration, setup.geometry.indentation);
        let motions = planes.iter().map(|plane| {
            let motions = discs.motions(plane);
            motions.map_err(|error| failed_press(plane, error))
        });
        let frames = CalibrationFrames {
            rest: frames.clone(),
            motions: motions.collect::<Result<_, _>>()?,
        };
        let changes = setup
            .models
            .changes(&frames, rest)
            .map_err(|error| FieldError::at(PATH, error))?;
        let presses = planes.iter().zip(changes.iter()).map(|(plane, changes)| {
            let moved = discs.displacements(plane);
            let moved = moved.map_err(|error| failed_press(plane, error))?;
            let markers = changes.iter().zip(moved).enumerate();
            let point =
                |(marker, (change, truth)): (usize, (&Option<Change>, MarkerDisplacement))| {
                    Some(CalibrationPoint {
                        marker,
                        normal: truth.normal,
                        tangential: truth.tangential,
                        change: (*change)?,
                    })
                };
            Ok(markers.filter_map(point).collect())
        });
        let presses = presses.collect::<Result<Vec<_>, FieldError>>()?;
        let only = match config.calibration.markers {
            ShownMarkers::All => None,
            ShownMarkers::UnderContact => discs.nearest([0.0; 2]),
        };
        let from = match config.normal_from {
            config::NormalFrom::Hue => NormalFrom::Hue,
            config::NormalFrom::Size => NormalFrom::Size,
            config::NormalFrom::Both => NormalFrom::Both,
        };
        let (calibration, stds) = Calibration::of_presses(&presses, only, from)
            .map_err(|error| FieldError::at(PATH, error))?;
        Ok(Self { calibration, stds })
    }
}

/// Geometry (object, contact and indentation) of each calibration press on a plane. If the config does not state the
/// deepest indentation, the deepest press has the indentation `indentation`.
fn planes(calibration: &CalibrationConfig, indentation: f64) -> Vec<ObjectPress> {
    let deepest = calibration.indentation.unwrap_or(indentation);
    let indentation = |press: u32| deepest * f64::from(press) / f64::from(calibration.presses);
    (1..=calibration.presses)
        .map(|press| ObjectPress {
            indentation: indentation(press),
            ..ObjectPress::default()
        })
        .collect()
}

fn failed_press(plane: &ObjectPress, error: PressError) -> FieldError {
    let message = format!(
        "a press on a plane, {} deep, fails: {error}",
        Number(plane.indentation)
    );
    FieldError::at(PATH, message)
}

/// Trial numbers above this number seed the noise of frames at rest. Smaller trial numbers seed the noise of frames of
/// calibration presses.
const ABOVE_PRESSES: u64 = AT_REST - 1000;

/// Inputs that determine the images of the markers at rest. The cache stores these images with the inputs as their key.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RestFrames {
    camera: SimulatedCamera,
    frames: u32,
}

impl RestFrames {
    /// The frames of a sensor at rest: `frames` frames over which the marker images are averaged, or one frame if the
    /// frames have no noise.
    pub(super) fn new(camera: &SimulatedCamera, frames: u32) -> Self {
        Self {
            camera: camera.clone(),
            frames: if camera.is_random { frames } else { 1 },
        }
    }

    pub(super) fn size(&self) -> usize {
        self.camera.optics.array().places().len()
    }

    pub(super) fn markers(&self) -> Result<Vec<Option<Marker>>, PressFailure> {
        let measured = self.measurements(AT_REST)?.into_iter();
        Ok(measured.map(|one| one.map(|one| one.marker)).collect())
    }

    /// Images of the markers at rest, averaged over the frames, with the covariances of their errors. The trial numbers
    /// `first`, `first` − 1 and so on seed the noise of the frames.
    pub(super) fn measurements(
        &self,
        first: u64,
    ) -> Result<Vec<Option<MarkerMeasurement>>, PressFailure> {
        let mut measured = self.camera.at_rest(Some(first))?;
        let mut others = vec![Vec::new(); measured.len()];
        for frame in 1..u64::from(self.frames) {
            let markers = self.camera.at_rest(Some(first.wrapping_sub(frame)))?;
            for (others, one) in others.iter_mut().zip(markers) {
                others.extend(one.map(|one| one.marker));
            }
        }
        for (one, others) in measured.iter_mut().zip(&others) {
            if let Some(one) = one {
                one.marker = one.marker.averaged(others);
                // The features are means over all frames.
                let share = f64::from(self.frames.max(1)).recip();
                let covariance = &mut one.errors.covariance;
                *covariance = covariance.map(|row| row.map(|entry| share * entry));
            }
        }
        Ok(measured)
    }
}

pub(super) type RestMarkers = Arc<[Option<Marker>]>;

/// Inputs that determine the changes of the markers' images in calibration presses. The cache stores these changes with
/// the inputs as their key.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CalibrationFrames {
    rest: RestFrames,
    motions: Vec<Vec<MarkerMotion>>,
}

/// For each calibration press, the change of each marker's image; `None` if the marker was not tracked.
pub(super) type ImageChanges = Arc<[Vec<Option<Change>>]>;

impl CalibrationFrames {
    pub(super) fn size(&self) -> usize {
        self.rest.size() * (1 + self.motions.len())
    }

    pub(super) fn changes(&self, rest: &[Option<Marker>]) -> Result<ImageChanges, PressFailure> {
        let camera = &self.rest.camera;
        let change = |(motions, press): (&Vec<MarkerMotion>, u64)| {
            let motions: Vec<_> = motions.iter().copied().map(Some).collect();
            let tracked = camera.track(rest, &motions, Some(ABOVE_PRESSES - press))?;
            let tracks = tracked.tracks.iter();
            Ok(tracks
                .map(|track| camera.lens.change(track.as_ref()?))
                .collect())
        };
        self.motions.iter().zip(1..).map(change).collect()
    }
}
