//! The calibration of a camera sensor, by presses on a plane.

use palpate_press::{MarkerDisplacement, PressError};
use palpate_statistics::Number;
use palpate_tracking::{
    Calibration, CalibrationError, Change, LateralCalibration, LateralPoint, Marker,
    NormalCalibration, NormalFrom, NormalPoint,
};

use super::super::looks::{PressLooks, RestLook};
use super::super::parts::Parts;
use super::super::pressed::Pressed;
use super::discs::DiscMarkers;
use palpate_study::FieldError;
use palpate_study::config::{self, CalibrationConfig, CameraConfig, ShownMarkers};

const PATH: &str = "scene.sensor.calibration";

/// A calibration, and the errors of the displacements that it yields.
pub(super) struct CalibratedCamera {
    pub(super) calibration: Calibration,
    /// Standard deviations of normal and tangential displacements near a contact.
    pub(super) stds: [Option<f64>; 2],
}

/// Marker of a calibration press: its known displacement, and how its picture changed.
struct Shown {
    marker: usize,
    known: MarkerDisplacement,
    change: Change,
}

/// Presses on a plane that calibrate a camera.
pub(super) struct CalibrationPresses<'a> {
    pub(super) camera: &'a CameraConfig,
    pub(super) discs: &'a DiscMarkers<'a>,
    pub(super) parts: &'a Parts,
    pub(super) look: &'a RestLook,
    /// Markers at rest.
    pub(super) rest: &'a [Option<Marker>],
    /// Indentation of the deepest press, if the config does not state it.
    pub(super) indentation: f64,
}

impl CalibrationPresses<'_> {
    /// Calibrates the sensor by presses of its apex on a plane, with known displacements.
    pub(super) fn calibrated(&self) -> Result<CalibratedCamera, FieldError> {
        let shown = self.shown()?;
        let calibration = self
            .fit(&shown)
            .map_err(|error| FieldError::at(PATH, error))?;
        let stds = residuals(&calibration, &shown);
        Ok(CalibratedCamera { calibration, stds })
    }

    /// Tracked markers of each press, with the changes of their pictures.
    fn shown(&self) -> Result<Vec<Vec<Shown>>, FieldError> {
        let presses = planes(&self.camera.calibration, self.indentation);
        let motions = presses.iter().map(|plane| {
            let motions = self.discs.motions(plane);
            motions.map_err(|error| refused(plane, error))
        });
        let looks = PressLooks {
            rest: self.look.clone(),
            motions: motions.collect::<Result<_, _>>()?,
        };
        let changes = self
            .parts
            .changes(&looks, self.rest)
            .map_err(|error| FieldError::at(PATH, error))?;
        let shown = presses.iter().zip(changes.iter()).map(|(plane, changes)| {
            let known = self.discs.displacements(plane);
            let known = known.map_err(|error| refused(plane, error))?;
            let markers = changes.iter().zip(known).enumerate();
            Ok(markers
                .filter_map(|(marker, (change, known))| {
                    Some(Shown {
                        marker,
                        known,
                        change: (*change)?,
                    })
                })
                .collect())
        });
        shown.collect()
    }

    fn fit(&self, shown: &[Vec<Shown>]) -> Result<Calibration, CalibrationError> {
        let only = match self.camera.calibration.markers {
            ShownMarkers::All => None,
            ShownMarkers::UnderContact => self.discs.nearest([0.0; 2]),
        };
        let all = || shown.iter().flatten();
        let normal: Vec<NormalPoint> = all()
            .filter(|shown| only.is_none_or(|only| only == shown.marker))
            .map(|shown| NormalPoint {
                marker: Some(shown.marker),
                normal: shown.known.normal,
                hue_turns: shown.change.hue_turns,
                growth: shown.change.growth,
            })
            .collect();
        let lateral: Vec<LateralPoint> = all()
            .map(|shown| LateralPoint {
                tangential: shown.known.tangential,
                shift_px: shown.change.shift_px,
                normal: Some(shown.known.normal),
            })
            .collect();
        let from = match self.camera.normal_from {
            config::NormalFrom::Hue => NormalFrom::Hue,
            config::NormalFrom::Size => NormalFrom::Size,
            config::NormalFrom::Both => NormalFrom::Both,
        };
        let normal = NormalCalibration::fit(&normal, from)?;
        let lateral = LateralCalibration::fit(&lateral)?;
        Calibration::new(Some(normal), Some(lateral), None)
    }
}

/// Calibration presses on a plane; `indentation` is the deepest one if the config states none.
pub(super) fn planes(calibration: &CalibrationConfig, indentation: f64) -> Vec<Pressed> {
    let deepest = calibration.indentation.unwrap_or(indentation);
    let indentation = |press: u32| deepest * f64::from(press) / f64::from(calibration.presses);
    (1..=calibration.presses)
        .map(|press| Pressed::on_plane(indentation(press)))
        .collect()
}

fn refused(plane: &Pressed, error: PressError) -> FieldError {
    let message = format!(
        "a press on a plane, {} deep, fails: {error}",
        Number(plane.indentation)
    );
    FieldError::at(PATH, message)
}

/// Rms errors of displacements in the calibration presses, over markers that move at least half as much as the
/// largest. There a marker's two discs move most differently, and the readings show the object's shape.
fn residuals(calibration: &Calibration, presses: &[Vec<Shown>]) -> [Option<f64>; 2] {
    let mut errors = [Vec::new(), Vec::new()];
    for shown in presses {
        let greatest = |size: fn(&MarkerDisplacement) -> f64| {
            let sizes = shown.iter().map(|shown| size(&shown.known));
            0.5 * sizes.fold(0.0, f64::max)
        };
        let (normal_limit, tangential_limit) = (greatest(inward), greatest(along));
        for Shown {
            marker,
            known,
            change,
        } in shown
        {
            let Some(normal) = calibration.normal(*marker, change) else {
                continue;
            };
            if inward(known) >= normal_limit {
                errors[0].push(normal - known.normal);
            }
            if along(known) >= tangential_limit
                && let Some([x, y]) = calibration.tangential(change.shift_px, normal)
            {
                errors[1].extend([x - known.tangential[0], y - known.tangential[1]]);
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
