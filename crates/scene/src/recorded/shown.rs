//! Calibration of a camera sensor from frames of known displacements.

use palpate_tracking::{Change, Equidistant, LateralPoint, NormalFrom, NormalPoint, Track};

use super::calibration::CalibrationPoints;
use super::error::RecordedError;
use super::tracked::{Frame, track_frames};

/// Known displacements of the marker under the contact, one for each pressed frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KnownOfFrames {
    /// Inward displacements, length.
    pub normal: Option<Vec<f64>>,
    /// Displacements along the skin, length, in whatever direction.
    pub tangential: Option<Vec<f64>>,
    /// Feature that tells normal displacements, and with them which marker is under the contact: the one that changes
    /// most.
    pub from: NormalFrom,
    /// Pixels per radian of the camera, where they are known; else the frames' pixels count as those of their middle.
    pub px_per_rad: Option<f64>,
}

/// The points that frames show, and how many markers the first, at rest, has.
///
/// # Errors
/// [`RecordedError::Readings`] for a frame without markers, of another size or of another sensor, where there are not
/// as many displacements as pressed frames, and for a camera of no scale.
pub fn calibration_points_of_frames(
    rest: &Frame,
    pressed: &[Frame],
    known: &KnownOfFrames,
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
            .ok_or_else(|| refused("shows no marker of the frame at rest again".to_owned()))?;
        let change = change(&frames.tracks[marker]).unwrap_or_default();
        let of_frame = |numbers: &Option<Vec<f64>>| match numbers {
            None => Ok(None),
            Some(numbers) => match numbers.get(index) {
                Some(number) => Ok(Some(*number)),
                None => Err(refused(format!(
                    "is pressed frame {}, and {} displacements are known",
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

/// Strength of a change by which a marker under the contact stands out.
fn strength(change: &Change, known: &KnownOfFrames) -> f64 {
    match (&known.normal, known.from) {
        (None, _) => libm::hypot(change.shift_px[0], change.shift_px[1]),
        (Some(_), NormalFrom::Hue) => change.hue_turns,
        (Some(_), NormalFrom::Size | NormalFrom::Both) => change.growth,
    }
}
