//! Writes calibrations to TOML files and reads them.

use palpate_study::config::LengthUnit;
use palpate_tracking::{
    Calibration, LateralCalibration, Line, MarkerGain, NormalCalibration, NormalFrom,
};
use serde::{Deserialize, Serialize};

use super::RecordedFile;
use super::camera_file::is_camera;
use super::error::RecordedError;

const HEADER: &str = "# Calibration of a camera sensor: how the picture of a marker depends on its displacement. Written by
# `palpate sensor calibrate`, read by `palpate sensor track --calibration`.
#
# Lengths are in length_unit. [normal]: displacement = signal / slope, where the signal is
# hue_weight x change of hue in turns + nearness_weight x (1 - diameter at rest / diameter pressed);
# if per_marker is true, this is multiplied by the gain of the marker, if it has one. [lateral]:
# displacement = shift of the centroid in px / (px_per_length + per_indentation x normal
# displacement). Displacements are computed from `line`, which goes through the origin;
# `with_intercept` is for comparison. Residuals are of displacements: rms, and std with the degrees
# of freedom as divisor.

";

#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CalibrationFile {
    length_unit: LengthUnit,
    markers: Option<usize>,
    hue_turns: Option<f64>,
    normal: Option<NormalPart>,
    lateral: Option<LateralCalibration>,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NormalPart {
    from: NormalFrom,
    hue_weight: f64,
    nearness_weight: f64,
    /// Smallest and largest stated displacement of the calibration points to which the line was fitted.
    range: [f64; 2],
    per_marker: bool,
    line: Line,
    with_intercept: Option<Line>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    marker: Vec<MarkerGain>,
}

/// Converts a calibration to the text of a TOML file. [`parse_calibration`] reads exactly the same calibration from
/// this text.
pub fn calibration_toml(calibration: &Calibration, length_unit: LengthUnit) -> String {
    let file = CalibrationFile {
        length_unit,
        markers: calibration.markers,
        hue_turns: calibration.hue_turns,
        normal: calibration.normal_part.as_ref().map(NormalPart::of),
        lateral: calibration.lateral_part.as_ref().copied(),
    };
    let body = toml::to_string(&file).expect("numbers, words and tables of them have a TOML form");
    // Write −0 as 0.
    format!("{HEADER}{}", body.replace("= -0.0\n", "= 0.0\n"))
}

/// Reads a calibration and its unit of length from a file.
///
/// # Errors
/// [`RecordedError::File`] that states what is wrong and where.
pub fn parse_calibration(file: &RecordedFile) -> Result<(Calibration, LengthUnit), RecordedError> {
    let text = file.text("a calibration is needed, as `palpate sensor calibrate` writes it")?;
    if is_camera(text) {
        return Err(file.error(
            "is a camera from a frame at rest, not a calibration of displacements; it is of use to the method image",
        ));
    }
    let parsed: CalibrationFile = toml::from_str(text).map_err(|error| {
        let error = error.to_string();
        file.error(format!("is no calibration: {}", error.trim_end()))
    })?;
    let normal = parsed.normal.map(NormalPart::part);
    let calibration = Calibration::new(normal, parsed.lateral, parsed.markers);
    let mut calibration = calibration.map_err(|error| file.error(error.to_string()))?;
    calibration.hue_turns = parsed.hue_turns.filter(|hue| hue.is_finite());
    Ok((calibration, parsed.length_unit))
}

impl NormalPart {
    fn of(part: &NormalCalibration) -> Self {
        let [hue_weight, nearness_weight] = part.weights;
        Self {
            from: part.from,
            hue_weight,
            nearness_weight,
            range: part.range,
            per_marker: part.uses_gains,
            line: part.line,
            with_intercept: part.with_intercept,
            marker: part.gains.clone(),
        }
    }

    fn part(self) -> NormalCalibration {
        NormalCalibration {
            from: self.from,
            weights: [self.hue_weight, self.nearness_weight],
            line: self.line,
            with_intercept: self.with_intercept,
            range: self.range,
            gains: self.marker,
            uses_gains: self.per_marker,
        }
    }
}
