//! Calibration of a camera sensor from frames of known displacements.

use palpate_tracking::{Change, Equidistant, LateralPoint, NormalFrom, NormalPoint, Track};

use super::calibration::CalibrationPoints;
use super::error::RecordedError;
use super::frame_pair::{Frame, track_frames};

/// Known displacements of the marker under the contact, one for each pressed frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KnownDisplacements {
    /// Inward displacements, length.
    pub normal: Option<Vec<f64>>,
    /// Displacements along the skin, length, in whatever direction.
    pub tangential: Option<Vec<f64>>,
    /// Feature from which normal displacements are estimated. With them, the marker under the contact is the one
    /// whose feature changes most.
    pub from: NormalFrom,
    /// Pixels per radian of the camera, if known; otherwise shifts in px are not corrected for the lens.
    pub px_per_rad: Option<f64>,
}

/// Calibration points from frames, and the number of markers in the frame at rest.
///
/// # Errors
/// [`RecordedError::Readings`] for a frame without markers, of another size or of another sensor, for fewer
/// displacements than pressed frames, and for an invalid scale of the camera.
pub fn frame_calibration_points(
    rest: &Frame,
    pressed: &[Frame],
    known: &KnownDisplacements,
) -> Result<(CalibrationPoints, usize), RecordedError> {
    let (mut normal, mut lateral) = (Vec::new(), Vec::new());
    let mut markers = 0;
    for (index, frame) in pressed.iter().enumerate() {
        let refused = |message: String| RecordedError::Readings {
            file: frame.file.clone(),
            message,
        };
        let frames = track_frames(rest, frame)?;
        frames.of_one_sensor()?;
        markers = frames.at_rest();
        let lens = known
            .px_per_rad
            .map(|px_per_rad| Equidistant::new(frames.centre_px, px_per_rad))
            .transpose()
            .map_err(|error| refused(error.to_string()))?;
        let change = |track: &Track| match &lens {
            Some(lens) => lens.change(track),
            None => track.change(),
        };
        let strength = |track: &Track| change(track).map(|change| strength(&change, known));
        let (marker, _) = frames
            .strongest(strength)
            .ok_or_else(|| refused("no marker of the frame at rest was found again".to_owned()))?;
        let change = change(&frames.tracks[marker]).unwrap_or_default();
        let of_frame = |numbers: &Option<Vec<f64>>| match numbers {
            None => Ok(None),
            Some(numbers) => match numbers.get(index) {
                Some(number) => Ok(Some(*number)),
                None => Err(refused(format!(
                    "is pressed frame {}, but only {} displacements are given",
                    index + 1,
                    numbers.len()
                ))),
            },
        };
        let inward = of_frame(&known.normal)?;
        if let Some(inward) = inward {
            normal.push(NormalPoint {
                marker: Some(marker),
                normal: inward,
                hue_turns: change.hue_turns,
                growth: change.growth,
            });
        }
        if let Some(along) = of_frame(&known.tangential)? {
            lateral.push(LateralPoint {
                tangential: [along.abs(), 0.0],
                shift_px: [libm::hypot(change.shift_px[0], change.shift_px[1]), 0.0],
                normal: inward,
            });
        }
    }
    let last = pressed.last().map_or("", |frame| &frame.file);
    let source = format!("{} to {last}", rest.file);
    Ok((CalibrationPoints::shown(source, &normal, &lateral), markers))
}

/// Size of a marker's change, which is largest under the contact.
fn strength(change: &Change, known: &KnownDisplacements) -> f64 {
    match (&known.normal, known.from) {
        (None, _) => libm::hypot(change.shift_px[0], change.shift_px[1]),
        (Some(_), NormalFrom::Hue) => change.hue_turns,
        (Some(_), NormalFrom::Size | NormalFrom::Both) => change.growth,
    }
}
