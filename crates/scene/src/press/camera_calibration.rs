//! Calibration of a camera sensor. It needs frames at rest, and presses on a plane.

use std::sync::Arc;

use palpate_chromatouch::MarkerMotion;
use palpate_press::{MarkerDisplacement, PressError};
use palpate_statistics::Number;
use palpate_study::FieldError;
use palpate_study::config::{self, CalibrationConfig, CameraConfig, ShownMarkers};
use palpate_tracking::{
    Calibration, CalibrationError, Change, LateralCalibration, LateralPoint, Marker,
    NormalCalibration, NormalFrom, NormalPoint,
};

use super::PressFailure;
use super::camera_model::{AT_REST, MarkerMeasurement, SimulatedCamera};
use super::plan::PressSetup;
use super::truth::{DiscMarkers, PressGeometry};

const PATH: &str = "scene.sensor.calibration";

#[derive(Clone, Debug)]
pub(super) struct CameraCalibration {
    pub(super) calibration: Calibration,
    /// Standard deviations of the errors that the calibration causes near a contact: first the error of normal
    /// displacements, then the error of tangential displacements. `None` for a standard deviation that is 0 or cannot
    /// be computed.
    pub(super) stds: [Option<f64>; 2],
}

struct CalibrationPoint {
    marker: usize,
    truth: MarkerDisplacement,
    change: Change,
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
            Ok(markers
                .filter_map(|(marker, (change, truth))| {
                    Some(CalibrationPoint {
                        marker,
                        truth,
                        change: (*change)?,
                    })
                })
                .collect())
        });
        let presses = presses.collect::<Result<Vec<_>, FieldError>>()?;
        let only = match config.calibration.markers {
            ShownMarkers::All => None,
            ShownMarkers::UnderContact => discs.nearest([0.0; 2]),
        };
        let calibration =
            fit(&presses, only, config.normal_from).map_err(|error| FieldError::at(PATH, error))?;
        Ok(Self {
            stds: residual_stds(&calibration, &presses),
            calibration,
        })
    }
}

/// Fits a calibration to the readings of the markers in the calibration presses. All markers are used for tangential
/// displacements. For normal displacements, only the marker with the index `only` is used; all markers if `only` is
/// `None`.
fn fit(
    presses: &[Vec<CalibrationPoint>],
    only: Option<usize>,
    normal_from: config::NormalFrom,
) -> Result<Calibration, CalibrationError> {
    let all = || presses.iter().flatten();
    let normal: Vec<NormalPoint> = all()
        .filter(|point| only.is_none_or(|only| only == point.marker))
        .map(|point| NormalPoint {
            marker: Some(point.marker),
            normal: point.truth.normal,
            hue_turns: point.change.hue_turns,
            growth: point.change.growth,
        })
        .collect();
    let lateral: Vec<LateralPoint> = all()
        .map(|point| LateralPoint {
            tangential: point.truth.tangential,
            shift_px: point.change.shift_px,
            normal: Some(point.truth.normal),
        })
        .collect();
    let from = match normal_from {
        config::NormalFrom::Hue => NormalFrom::Hue,
        config::NormalFrom::Size => NormalFrom::Size,
        config::NormalFrom::Both => NormalFrom::Both,
    };
    let normal = NormalCalibration::fit(&normal, from)?;
    let lateral = LateralCalibration::fit(&lateral)?;
    Calibration::new(Some(normal), Some(lateral), None)
}

/// Geometry (object, contact and indentation) of each calibration press on a plane. If the config does not state the
/// deepest indentation, the deepest press has the indentation `indentation`.
fn planes(calibration: &CalibrationConfig, indentation: f64) -> Vec<PressGeometry> {
    let deepest = calibration.indentation.unwrap_or(indentation);
    let indentation = |press: u32| deepest * f64::from(press) / f64::from(calibration.presses);
    (1..=calibration.presses)
        .map(|press| PressGeometry::on_plane(indentation(press)))
        .collect()
}

fn failed_press(plane: &PressGeometry, error: PressError) -> FieldError {
    let message = format!(
        "a press on a plane, {} deep, fails: {error}",
        Number(plane.indentation)
    );
    FieldError::at(PATH, message)
}

/// Root mean square errors of normal and of tangential displacements in the calibration presses; `None` if an error is
/// 0 or cannot be computed. Only markers whose displacement is at least half of the largest displacement are used.
/// These markers are near the contact. There, the motions of a marker's two discs differ most, and the readings depend
/// most on the object's shape.
fn residual_stds(calibration: &Calibration, presses: &[Vec<CalibrationPoint>]) -> [Option<f64>; 2] {
    let mut errors = [Vec::new(), Vec::new()];
    for points in presses {
        let half_of_largest = |size: fn(&MarkerDisplacement) -> f64| {
            let sizes = points.iter().map(|point| size(&point.truth));
            0.5 * sizes.fold(0.0, f64::max)
        };
        let (normal_limit, tangential_limit) = (half_of_largest(inward), half_of_largest(along));
        for point in points {
            let (truth, change) = (&point.truth, &point.change);
            let Some(normal) = calibration.normal(point.marker, change) else {
                continue;
            };
            if inward(truth) >= normal_limit {
                errors[0].push(normal - truth.normal);
            }
            if along(truth) >= tangential_limit
                && let Some([x, y]) = calibration.tangential(change.shift_px, normal)
            {
                errors[1].extend([x - truth.tangential[0], y - truth.tangential[1]]);
            }
        }
    }
    errors.map(|errors| {
        let squares = errors.iter().map(|error: &f64| error * error);
        let mean = squares.sum::<f64>() / errors.len() as f64;
        Some(mean.sqrt()).filter(|std| *std > 0.0)
    })
}

fn inward(moved: &MarkerDisplacement) -> f64 {
    moved.normal.abs()
}

fn along(moved: &MarkerDisplacement) -> f64 {
    libm::hypot(moved.tangential[0], moved.tangential[1])
}

/// Trial numbers above this number seed the noise of frames at rest. Smaller trial numbers seed the noise of frames of
/// calibration presses.
const ABOVE_PRESSES: u64 = AT_REST - 1000;

/// Inputs that determine the images of the markers at rest. The cache stores these images with the inputs as their key.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RestFrames {
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

    pub(crate) fn size(&self) -> usize {
        self.camera.optics.array().places().len()
    }

    pub(crate) fn markers(&self) -> Result<Vec<Option<Marker>>, PressFailure> {
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
                one.marker = mean(one.marker, others);
                one.errors = one.errors.averaged(self.frames);
            }
        }
        Ok(measured)
    }
}

pub(crate) type RestMarkers = Arc<[Option<Marker>]>;

/// Inputs that determine the changes of the markers' images in calibration presses. The cache stores these changes with
/// the inputs as their key.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CalibrationFrames {
    rest: RestFrames,
    motions: Vec<Vec<MarkerMotion>>,
}

/// For each calibration press, the change of each marker's image; `None` if the marker was not tracked.
pub(crate) type ImageChanges = Arc<[Vec<Option<Change>>]>;

impl CalibrationFrames {
    pub(crate) fn size(&self) -> usize {
        self.rest.size() * (1 + self.motions.len())
    }

    pub(crate) fn changes(&self, rest: &[Option<Marker>]) -> Result<ImageChanges, PressFailure> {
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

fn mean(first: Marker, others: &[Marker]) -> Marker {
    // Sum the differences from the first image: of both centroid coordinates, the hue, the mean hue and the size. Hues
    // are angles, so only their differences can be summed.
    let mut sums = [0.0; 5];
    for marker in others {
        let turn = marker.hue_turns - first.hue_turns;
        let differences = [
            marker.centroid_px[0] - first.centroid_px[0],
            marker.centroid_px[1] - first.centroid_px[1],
            turn - (turn + 0.5).floor(),
            marker.mean_hue_turns - first.mean_hue_turns,
            marker.size_px2 - first.size_px2,
        ];
        for (sum, difference) in sums.iter_mut().zip(differences) {
            *sum += difference;
        }
    }
    let [x, y, hue, mean_hue, size] = sums.map(|sum| sum / (1.0 + others.len() as f64));
    Marker {
        centroid_px: [first.centroid_px[0] + x, first.centroid_px[1] + y],
        hue_turns: (first.hue_turns + hue).rem_euclid(1.0),
        mean_hue_turns: first.mean_hue_turns + mean_hue,
        size_px2: first.size_px2 + size,
        ..first
    }
}
