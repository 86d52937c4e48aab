//! Place and scale of a camera, from one frame at rest and the layout that it shows.

mod matched;
mod meant;
mod nearest;
mod report;
mod written;

pub(super) use matched::{CAMERA, CONTRADICTED, DOUBTED};
pub(super) use meant::{Meant, Stand};
pub use report::{Residual, RestCamera};
pub(super) use written::is_camera;
pub use written::{parse_camera, read_camera};

use palpate_press::Seen;
use palpate_study::config::{
    CameraConfig, LengthUnit, PressConfig, PressSensorConfig, SceneConfig, StudyConfig,
};
use palpate_tracking::Found;

use super::error::RecordedError;
use super::tracked::{Frame, find};
use crate::plan::PlanError;
use matched::Matched;
use meant::TERMS_BEFORE;

/// Lowest level of the ground's green, of 255, that markers are measured on, and largest share of it at full scale.
const DARKEST: u8 = 40;
const MOST_SATURATED: f64 = 0.5;
/// Largest standard deviation of an odd term that a frame determines, as a share of that which is known beforehand.
const DETERMINED: f64 = 0.5;

/// The camera that shows the markers of a study's sensor so at rest. The study, or one of its cells, is of a press by a camera: it
/// states layout, discs, the frame's size, the lens and where the camera is meant to be. Odd terms of the lens are fitted as
/// far as the frame determines them, k3 before k5: to half of what fisheyes differ by, or better; else they stay those of the
/// study.
///
/// # Errors
/// [`RecordedError::Readings`] for a study that has no camera, a frame of another size, without the layout's markers, in
/// other colours, saturated or under-exposed, and one that contradicts the layout; each with its numbers.
pub fn calibrate_camera(rest: &Frame, study: &StudyConfig) -> Result<RestCamera, RecordedError> {
    let fail = |message: String| RecordedError::Readings {
        file: rest.file.clone(),
        message,
    };
    let of_study = |error: PlanError| fail(format!("{}: {}", error.path, error.message));
    let (press, camera) = sensor(&study.scene).map_err(of_study)?;
    let meant = Meant::of(press, camera).and_then(Meant::through_blemishes);
    let meant = meant.map_err(of_study)?;
    usable(rest, camera).map_err(fail)?;
    let found = find(rest)?;
    let seen = SeenAtRest::of(&meant, &found, study.length_unit);
    seen.map(|seen| seen.camera).map_err(fail)
}

/// Whether a frame tells the odd terms that were fitted to it.
fn is_determined(camera: &RestCamera) -> bool {
    let stds = [camera.k3_std, camera.k5_std].into_iter().zip(TERMS_BEFORE);
    let mut fitted = stds.filter_map(|(std, before)| Some((std?, before)));
    fitted.all(|(std, before)| std <= DETERMINED * before)
}

/// Markers of a layout, as a frame at rest shows them.
pub(super) struct SeenAtRest {
    /// The camera that shows them so.
    pub(super) camera: RestCamera,
    /// Doubt where markers are missing.
    pub(super) missing: Option<String>,
    /// Each marker of the layout; `None` for those that the frame does not show whole.
    pub(super) seen: Vec<Option<Seen>>,
    /// Number among those found of each.
    pub(super) found: Vec<Option<usize>>,
}

impl SeenAtRest {
    /// Matches the markers that were found in a frame with those that are meant.
    pub(super) fn of(meant: &Meant<'_>, found: &Found, unit: LengthUnit) -> Result<Self, String> {
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
        // As many odd terms of the lens as the frame determines.
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

/// The press of a study's scene, and the camera before it.
pub(super) fn sensor(scene: &SceneConfig) -> Result<(&PressConfig, &CameraConfig), PlanError> {
    let SceneConfig::Press(press) = scene else {
        return Err(PlanError::at("scene.kind", "must be \"press\""));
    };
    Ok((press, camera_of(press)?))
}

/// The camera before a press.
pub(super) fn camera_of(press: &PressConfig) -> Result<&CameraConfig, PlanError> {
    match &press.sensor {
        PressSensorConfig::Projected(camera) | PressSensorConfig::Rendered(camera) => Ok(camera),
        PressSensorConfig::Direct { .. } => {
            Err(PlanError::at("scene.sensor", "must have a camera"))
        }
    }
}

/// Refuses frames that a camera does not take, or takes too dark or too bright to tell colours.
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

/// Refuses frames that are too dark or too bright to tell colours.
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
