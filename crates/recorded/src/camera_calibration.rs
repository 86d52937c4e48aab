//! Estimates the pose and the scale of a camera from one frame at rest and the layout of its markers.

use palpate_frames::Compression;
use palpate_press::Seen;
use palpate_study::config::{CameraConfig, LengthUnit, StudyConfig};
use palpate_study::{FieldError, Warning};
use palpate_tracking::Found;

use super::camera_file::CameraEstimate;
use super::error::RecordedError;
use super::frame_pair::{Frame, find};
use super::layout_matching::Matched;
use super::nominal_sensor::{NominalSensor, TERM_STDS};
use super::study_options::press_of;

/// Smallest accepted green level (0 to 255) of a frame's background.
const MIN_GROUND: u8 = 40;
/// Largest accepted share of saturated pixels (green level 255) in the centre of a frame.
const MAX_SATURATED: f64 = 0.5;
/// A lens coefficient (k3 or k5) counts as determined by the frame if its standard error is at most this share of its
/// prior standard deviation.
const MAX_TERM_SHARE: f64 = 0.5;

/// Fits a camera to the markers of a frame at rest. The study (or grid point of a study) must be a press with a camera.
/// It states the layout, the discs, the frame size, the lens and the nominal camera pose. The odd terms of the lens, k3
/// and k5, are fitted only if the frame determines them: their standard errors must be at most half of their prior
/// standard deviations. Otherwise k5, or both terms, have the values of the study.
///
/// # Errors
/// [`RecordedError::Readings`] in these cases: the study has no camera; the frame has another size or other colours
/// than the study states, lacks markers of the layout, is saturated or under-exposed, or contradicts the layout. The
/// message states the values.
pub fn calibrate_camera(
    rest: &Frame,
    study: &StudyConfig,
) -> Result<CameraEstimate, RecordedError> {
    let fail = |message: String| RecordedError::readings(&rest.file, message);
    let of_study = |error: FieldError| fail(error.to_string());
    let press = press_of(study).map_err(of_study)?;
    let nominal = NominalSensor::of(press).and_then(NominalSensor::through_blemishes);
    let nominal = nominal.map_err(of_study)?;
    usable(rest, nominal.camera).map_err(fail)?;
    let at_rest = MarkersAtRest::of(&nominal, &find(rest)?, study.length_unit);
    let mut camera = at_rest.map_err(fail)?.camera;
    let of_colours = compressed(rest).map(|remedy| {
        format!("the lens of the camera may be wrong, and curvatures biased by several percent; {remedy}")
    });
    camera
        .warnings
        .extend(Warning::of("subsampled-colours", of_colours));
    Ok(camera)
}

/// Text for errors and warnings that the camera and the frame at rest contradict each other: a likely cause is that
/// JPEG stores the colours of the frame with fewer pixels (subsampled). `None` if the frame's colours are not
/// subsampled.
pub(super) fn compressed(rest: &Frame) -> Option<String> {
    let compression = rest.compression.filter(|one| one.subsamples_colours)?;
    Some(format!(
        "a likely cause is the compression of {} as {} with subsampled colours: use a lossless format, such as PNG, or JPEG 4:4:4",
        rest.file, compression.format
    ))
}

fn is_determined(camera: &CameraEstimate) -> bool {
    let stds = [camera.k3_std, camera.k5_std].into_iter().zip(TERM_STDS);
    let mut fitted = stds.filter_map(|(std, before)| Some((std?, before)));
    fitted.all(|(std, before)| std <= MAX_TERM_SHARE * before)
}

/// Markers of a layout, matched with the markers that were found in a frame at rest.
pub(super) struct MarkersAtRest {
    pub(super) camera: CameraEstimate,
    pub(super) missing: Option<Warning>,
    /// Image of each marker of the layout; `None` if the marker is not completely visible in the frame.
    pub(super) pictures: Vec<Option<Seen>>,
    /// Index of each marker of the layout in the list of markers found in the frame; `None` if the marker was not
    /// found.
    pub(super) found: Vec<Option<usize>>,
}

impl MarkersAtRest {
    pub(super) fn of(
        nominal: &NominalSensor<'_>,
        found: &Found,
        unit: LengthUnit,
    ) -> Result<Self, String> {
        let optics = nominal.optics(found);
        let optics = optics.map_err(|error| format!("{}: {}", error.path, error.message))?;
        let with_terms = |free: usize| -> Result<Self, String> {
            let nominal = nominal.with_terms(free);
            let (matched, optics) = Matched::of(&nominal, &optics, found)?;
            Ok(Self {
                camera: matched.camera(&nominal, &optics, unit)?,
                missing: matched.warning(),
                pictures: matched.images,
                found: matched.found,
            })
        };
        // First try to fit both lens coefficients k3 and k5, then only k3, then neither, until the frame determines
        // every fitted coefficient.
        for free in (1..=TERM_STDS.len()).rev() {
            if let Ok(at_rest) = with_terms(free)
                && is_determined(&at_rest.camera)
            {
                return Ok(at_rest);
            }
        }
        with_terms(0)
    }
}

/// Smallest accepted quality of JPEG frames. In frames with a lower quality, the markers contradict the layout, or the
/// 95 % intervals of the estimate are too narrow.
const MIN_JPEG_QUALITY: f64 = 92.0;

/// Returns an error if a frame has another size than the frames of `camera`, is compressed too much, or is too dark or
/// too bright to distinguish colours.
pub(super) fn usable(frame: &Frame, camera: &CameraConfig) -> Result<(), String> {
    let (width, height) = frame.image.dimensions();
    if width != camera.size_px || height != camera.size_px {
        return Err(format!(
            "has {width} x {height} px; the layout's camera takes {0} x {0}",
            camera.size_px
        ));
    }
    let is_poor = |one: &Compression| match one.quality {
        Some(quality) => quality < MIN_JPEG_QUALITY,
        None => one.format != "JPEG",
    };
    if let Some(Compression {
        format, quality, ..
    }) = frame.compression.filter(is_poor)
    {
        let quality = quality.map_or(String::new(), |quality| format!(" with quality {quality}"));
        return Err(format!(
            "is compressed as {format}{quality}, which moves and colours the edges of the markers by more than their noise; JPEG with a quality of at least {MIN_JPEG_QUALITY} is required, or a format without loss such as PNG"
        ));
    }
    let mut levels: Vec<u8> = frame.image.pixels().map(|pixel| pixel.0[1]).collect();
    levels.sort_unstable();
    let ground = levels[levels.len() * 3 / 4];
    if ground < MIN_GROUND {
        return Err(format!(
            "is under-exposed: a quarter of its pixels are brighter than {ground} of 255 in green; the background must reach {MIN_GROUND}"
        ));
    }
    let middle = |at: u32, size: u32| (size / 4..size - size / 4).contains(&at);
    let inner = frame.image.enumerate_pixels();
    let inner = inner.filter(|(x, y, _)| middle(*x, width) && middle(*y, height));
    let (mut count, mut full) = (0.0, 0.0);
    for (_, _, pixel) in inner {
        count += 1.0;
        full += f64::from(u8::from(pixel.0[1] == u8::MAX));
    }
    if full > MAX_SATURATED * count {
        return Err(format!(
            "is saturated: {:.0} % of the pixels near its middle have the largest green value; at most {:.0} % may have it",
            100.0 * full / count,
            100.0 * MAX_SATURATED
        ));
    }
    Ok(())
}
