//! Calibrations as TOML files.

use std::path::Path;

use palpate_tracking::{
    Calibration, CalibrationError, LateralCalibration, Line, MarkerGain, NormalCalibration,
    NormalFrom,
};
use serde::{Deserialize, Serialize};

use super::RecordedFile;
use super::camera_calibration::is_camera;
use super::error::RecordedError;
use palpate_study::config::LengthUnit;

const HEADER: &str = "\
# Calibration of a camera sensor: how the sight of a marker follows its displacement. TextTable by
# `palpate sensor calibrate`, read by `palpate sensor track --calibration`.
#
# Lengths are in length_unit. [normal]: displacement = signal / slope, where the signal is
# hue_weight x change of hue in turns + nearness_weight x (1 - diameter at rest / diameter pressed);
# where per_marker is true, this is multiplied with the gain of a marker that has one. [lateral]:
# displacement = shift of the centroid in px / (px_per_length + per_indentation x normal
# displacement). A `line` goes through rest and is what displacements are read from,
# `with_intercept` is for comparison. Residuals are of displacements: rms, and std with the degrees
# of freedom as divisor.

";

#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CalibrationFile {
    length_unit: LengthUnit,
    /// Number of markers that the frame at rest shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    markers: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    normal: Option<NormalPart>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    lateral: Option<LateralPart>,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NormalPart {
    from: SightName,
    hue_weight: f64,
    nearness_weight: f64,
    /// Smallest and largest displacement in the fit.
    range: [f64; 2],
    per_marker: bool,
    line: LinePart,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    with_intercept: Option<LinePart>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    marker: Vec<MarkerPart>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum SightName {
    Hue,
    Size,
    Both,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MarkerPart {
    marker: usize,
    gain: f64,
    line: LinePart,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LateralPart {
    px_per_length: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    px_per_length_std: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    per_indentation: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    per_indentation_std: Option<f64>,
    residual_rms: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    residual_std: Option<f64>,
    range: [f64; 2],
    normal_range: [f64; 2],
    line: LinePart,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    with_intercept: Option<LinePart>,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LinePart {
    slope: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    slope_std: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    intercept: Option<f64>,
    r_squared: f64,
    residual_rms: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    residual_std: Option<f64>,
    points: usize,
}

/// A calibration as TOML. [`read_calibration`] restores it exactly.
pub fn calibration_toml(calibration: &Calibration, length_unit: LengthUnit) -> String {
    let file = CalibrationFile {
        length_unit,
        markers: calibration.markers(),
        normal: calibration.normal_part().map(NormalPart::of),
        lateral: calibration.lateral_part().map(LateralPart::of),
    };
    let body = toml::to_string(&file).expect("numbers, words and tables of them have a TOML form");
    // Write −0 as 0.
    format!("{HEADER}{}", body.replace("= -0.0\n", "= 0.0\n"))
}

/// Reads a calibration, and the unit of its lengths.
///
/// # Errors
/// [`RecordedError::File`] with what is wrong and where.
pub fn read_calibration(path: &Path) -> Result<(Calibration, LengthUnit), RecordedError> {
    parse_calibration(&RecordedFile::read(path)?)
}

/// A calibration and its unit, as [`read_calibration`] reads them.
///
/// # Errors
/// Errors of [`read_calibration`].
pub fn parse_calibration(file: &RecordedFile) -> Result<(Calibration, LengthUnit), RecordedError> {
    let text = file.text("a calibration is needed, as `palpate sensor calibrate` writes it")?;
    if is_camera(text) {
        return Err(file.error(
            "is a camera that a frame at rest told, which knows no displacements; it is of use to the method image",
        ));
    }
    let parsed: CalibrationFile = toml::from_str(text).map_err(|error| {
        file.error(format!(
            "is no calibration: {}",
            error.to_string().trim_end()
        ))
    })?;
    let unit = parsed.length_unit;
    let calibration = parsed
        .calibration()
        .map_err(|error| file.error(error.to_string()))?;
    Ok((calibration, unit))
}

impl CalibrationFile {
    fn calibration(self) -> Result<Calibration, CalibrationError> {
        Calibration::new(
            self.normal.map(NormalPart::part),
            self.lateral.map(LateralPart::part),
            self.markers,
        )
    }
}

impl SightName {
    const fn of(from: NormalFrom) -> Self {
        match from {
            NormalFrom::Hue => Self::Hue,
            NormalFrom::Size => Self::Size,
            NormalFrom::Both => Self::Both,
        }
    }

    const fn part(self) -> NormalFrom {
        match self {
            Self::Hue => NormalFrom::Hue,
            Self::Size => NormalFrom::Size,
            Self::Both => NormalFrom::Both,
        }
    }
}

impl NormalPart {
    fn of(part: &NormalCalibration) -> Self {
        let [hue_weight, nearness_weight] = part.weights;
        let marker = |gain: &MarkerGain| MarkerPart {
            marker: gain.marker,
            gain: gain.gain,
            line: LinePart::of(&gain.line),
        };
        Self {
            from: SightName::of(part.from),
            hue_weight,
            nearness_weight,
            range: part.range,
            per_marker: part.uses_gains,
            line: LinePart::of(&part.line),
            with_intercept: part.with_intercept.as_ref().map(LinePart::of),
            marker: part.gains.iter().map(marker).collect(),
        }
    }

    fn part(self) -> NormalCalibration {
        let gain = |marker: MarkerPart| MarkerGain {
            marker: marker.marker,
            gain: marker.gain,
            line: marker.line.part(),
        };
        NormalCalibration {
            from: self.from.part(),
            weights: [self.hue_weight, self.nearness_weight],
            line: self.line.part(),
            with_intercept: self.with_intercept.map(LinePart::part),
            range: self.range,
            gains: self.marker.into_iter().map(gain).collect(),
            uses_gains: self.per_marker,
        }
    }
}

impl LateralPart {
    fn of(part: &LateralCalibration) -> Self {
        Self {
            px_per_length: part.px_per_length,
            px_per_length_std: part.px_per_length_std,
            per_indentation: part.per_indentation,
            per_indentation_std: part.per_indentation_std,
            residual_rms: part.residual_rms,
            residual_std: part.residual_std,
            range: part.range,
            normal_range: part.normal_range,
            line: LinePart::of(&part.line),
            with_intercept: part.with_intercept.as_ref().map(LinePart::of),
        }
    }

    fn part(self) -> LateralCalibration {
        LateralCalibration {
            px_per_length: self.px_per_length,
            px_per_length_std: self.px_per_length_std,
            per_indentation: self.per_indentation,
            per_indentation_std: self.per_indentation_std,
            residual_rms: self.residual_rms,
            residual_std: self.residual_std,
            line: self.line.part(),
            with_intercept: self.with_intercept.map(LinePart::part),
            range: self.range,
            normal_range: self.normal_range,
        }
    }
}

impl LinePart {
    fn of(line: &Line) -> Self {
        Self {
            slope: line.slope,
            slope_std: line.slope_std,
            intercept: line.intercept,
            r_squared: line.r_squared,
            residual_rms: line.residual_rms,
            residual_std: line.residual_std,
            points: line.count,
        }
    }

    fn part(self) -> Line {
        Line {
            slope: self.slope,
            slope_std: self.slope_std,
            intercept: self.intercept,
            r_squared: self.r_squared,
            residual_rms: self.residual_rms,
            residual_std: self.residual_std,
            count: self.points,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_tracking::{LateralPoint, NormalPoint};

    fn written(text: &str) -> Result<(Calibration, LengthUnit), RecordedError> {
        let dir = tempfile::tempdir().expect("a temporary directory");
        let path = dir.path().join("calibration.toml");
        std::fs::write(&path, text).expect("writable");
        read_calibration(&path)
    }

    /// Calibration with all optional parts.
    fn full() -> Calibration {
        let steps = || (0..8).map(|step| 0.1 * f64::from(step));
        let normal = |marker: usize| {
            steps().map(move |normal| NormalPoint {
                marker: Some(marker),
                normal,
                hue_turns: (0.02 + 0.001 * marker as f64) * normal
                    + 1e-3 * libm::sin(30.0 * normal),
                growth: 0.05 * normal,
            })
        };
        let normal: Vec<_> = normal(1).chain(normal(7)).collect();
        let lateral: Vec<_> = steps()
            .map(|along| LateralPoint {
                tangential: [along, 0.3],
                shift_px: [7.1 * along, 2.2],
                normal: Some(along * along),
            })
            .collect();
        let normal = NormalCalibration::fit(&normal, NormalFrom::Both).expect("a slope");
        let lateral = LateralCalibration::fit(&lateral).expect("a slope");
        Calibration::new(Some(normal.per_marker()), Some(lateral), Some(77)).expect("parts")
    }

    #[test]
    fn what_is_written_is_read() {
        let calibration = full();
        assert_eq!(
            calibration.normal_part().map(|part| part.gains.len()),
            Some(2)
        );
        let text = calibration_toml(&calibration, LengthUnit::Cm);
        assert_eq!(
            written(&text).expect("sound"),
            (calibration, LengthUnit::Cm)
        );
    }

    #[test]
    fn what_is_missing_or_unknown_is_refused() {
        let text = calibration_toml(&full(), LengthUnit::Mm);
        let lines: Vec<&str> = text.lines().collect();
        for (index, line) in lines.iter().enumerate() {
            let Some((key, _)) = line.split_once(" = ") else {
                continue;
            };
            if line.starts_with('#') {
                continue;
            }
            let mut renamed = lines.clone();
            let other = line.replacen(key, "unheard_of", 1);
            renamed[index] = &other;
            let error = written(&renamed.join("\n")).expect_err(key).to_string();
            assert!(error.contains("unheard_of"), "{error}");
        }
        let error = written("length_unit = \"mm\"").expect_err("has no part");
        assert!(error.to_string().contains("0 parts"));
    }
}
