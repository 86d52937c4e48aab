//! Estimates pose and scale of a camera from one frame at rest and the known layout of its markers.

mod camera_file;
mod camera_report;
mod layout_matching;
mod nearest;
mod nominal_sensor;

pub(super) use camera_file::is_camera;
pub use camera_file::{parse_camera, read_camera};
pub use camera_report::{CameraEstimate, Residual};
pub(super) use layout_matching::{CAMERA, CONTRADICTED, SIGNIFICANCE_LEVEL};
pub(super) use nominal_sensor::{CameraGeometry, NominalSensor};

use palpate_press::Seen;
use palpate_study::config::{CameraConfig, LengthUnit, PressConfig, SceneConfig, StudyConfig};
use palpate_tracking::Found;

use super::error::RecordedError;
use super::frame_pair::{Frame, find};
use layout_matching::Matched;
use nominal_sensor::TERMS_BEFORE;
use palpate_study::{FieldError, Warning};

/// Lowest usable green level of the ground, of 255, and largest share of central pixels at full scale in green.
const DARKEST: u8 = 40;
const MOST_SATURATED: f64 = 0.5;
/// A frame determines an odd term if its standard deviation is at most this share of the prior one.
const DETERMINED: f64 = 0.5;

/// Fits a camera to the markers of a frame at rest. The study (or grid point of a study) must be a press with a
/// camera. It states layout, discs, frame size, lens and nominal camera pose. The odd terms of the lens, k3 before
/// k5, are fitted only if the frame determines them to half of their prior standard deviation or better. Otherwise
/// they keep the study's values.
///
/// # Errors
/// [`RecordedError::Readings`] if the study has no camera, or if the frame has another size, lacks the layout's
/// markers, has other colours, is saturated or under-exposed, or contradicts the layout; each with its numbers.
pub fn calibrate_camera(
    rest: &Frame,
    study: &StudyConfig,
) -> Result<CameraEstimate, RecordedError> {
    let fail = |message: String| RecordedError::Readings {
        file: rest.file.clone(),
        message,
    };
    let of_study = |error: FieldError| fail(format!("{}: {}", error.path, error.message));
    let (press, camera) = sensor(&study.scene).map_err(of_study)?;
    let meant = NominalSensor::of(press, camera).and_then(NominalSensor::through_blemishes);
    let meant = meant.map_err(of_study)?;
    usable(rest, camera).map_err(fail)?;
    let found = find(rest)?;
    let seen = SeenAtRest::of(&meant, &found, study.length_unit);
    seen.map(|seen| seen.camera).map_err(fail)
}

/// Whether the frame determines the odd terms that were fitted to it.
fn is_determined(camera: &CameraEstimate) -> bool {
    let stds = [camera.k3_std, camera.k5_std].into_iter().zip(TERMS_BEFORE);
    let mut fitted = stds.filter_map(|(std, before)| Some((std?, before)));
    fitted.all(|(std, before)| std <= DETERMINED * before)
}

/// Markers of a layout, matched in a frame at rest.
pub(super) struct SeenAtRest {
    /// The camera that was fitted to them.
    pub(super) camera: CameraEstimate,
    /// Warning if markers are missing.
    pub(super) missing: Option<Warning>,
    /// Picture of each marker of the layout; `None` if the frame does not show it whole.
    pub(super) seen: Vec<Option<Seen>>,
    /// Index of each marker of the layout in the list of found markers.
    pub(super) found: Vec<Option<usize>>,
}

impl SeenAtRest {
    /// Matches the markers found in a frame with the layout of the nominal sensor.
    pub(super) fn of(
        meant: &NominalSensor<'_>,
        found: &Found,
        unit: LengthUnit,
    ) -> Result<Self, String> {
        let optics = meant.optics(found);
        let optics = optics.map_err(|error| format!("{}: {}", error.path, error.message))?;
        let told = |unknown: usize| -> Result<Self, String> {
            let meant = meant.with_terms(unknown);
            let (matched, optics) = Matched::of(&meant, &optics, found)?;
            Ok(Self {
                camera: matched.camera(&meant, &optics, unit)?,
                missing: matched.warning(),
                seen: matched.seen,
                found: matched.found,
            })
        };
        // Fit as many odd terms of the lens as the frame determines.
        for unknown in (1..=TERMS_BEFORE.len()).rev() {
            if let Ok(seen) = told(unknown)
                && is_determined(&seen.camera)
            {
                return Ok(seen);
            }
        }
        told(0)
    }
}

/// The press of a study's scene, and its camera.
pub(super) fn sensor(scene: &SceneConfig) -> Result<(&PressConfig, &CameraConfig), FieldError> {
    let SceneConfig::Press(press) = scene else {
        return Err(FieldError::at("scene.kind", "must be \"press\""));
    };
    Ok((press, camera_of(press)?))
}

/// The camera of a press.
pub(super) fn camera_of(press: &PressConfig) -> Result<&CameraConfig, FieldError> {
    let none = || FieldError::at("scene.sensor", "must have a camera");
    press
        .sensor
        .camera()
        .map(|(camera, _)| camera)
        .ok_or_else(none)
}

/// Rejects frames of another size than the camera's, and frames too dark or too bright to distinguish colours.
pub(super) fn usable(frame: &Frame, camera: &CameraConfig) -> Result<(), String> {
    let (width, height) = frame.image.dimensions();
    if width != camera.size_px || height != camera.size_px {
        return Err(format!(
            "has {width} x {height} px; the layout's camera takes {0} x {0}",
            camera.size_px
        ));
    }
    exposed(frame)
}

/// Rejects frames that are too dark or too bright to distinguish colours.
fn exposed(rest: &Frame) -> Result<(), String> {
    let mut levels: Vec<u8> = rest.image.pixels().map(|pixel| pixel.0[1]).collect();
    levels.sort_unstable();
    let ground = levels[levels.len() * 3 / 4];
    if ground < DARKEST {
        return Err(format!(
            "is under-exposed: a quarter of its pixels are brighter than {ground} of 255 in green; the ground must reach {DARKEST}"
        ));
    }
    let middle = |at: u32, size: u32| (size / 4..size - size / 4).contains(&at);
    let (width, height) = rest.image.dimensions();
    let inner = rest.image.enumerate_pixels();
    let inner = inner.filter(|(x, y, _)| middle(*x, width) && middle(*y, height));
    let (count, full) = inner.fold((0.0, 0.0), |(count, full), (_, _, pixel)| {
        (
            count + 1.0,
            full + f64::from(u8::from(pixel.0[1] == u8::MAX)),
        )
    });
    if full > MOST_SATURATED * count {
        return Err(format!(
            "is saturated: {:.0} % of the pixels about its middle are at full scale in green; at most {:.0} % may be",
            100.0 * full / count,
            100.0 * MOST_SATURATED
        ));
    }
    Ok(())
}
