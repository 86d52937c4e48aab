//! Recorded presses.

use std::path::Path;

use super::RecordedFile;
use super::sheet::{Column, RecordedError, Sheet, header};
use palpate_study::config::LengthUnit;

/// One row per marker; the last two may be missing.
const COLUMNS: [Column; 5] = [
    Column::length("x"),
    Column::length("y"),
    Column::length("normal_displacement"),
    Column::length("tangential_x"),
    Column::length("tangential_y"),
];

/// One row per marker of a row of them through the apex.
const ALONG_A_ROW: [Column; 2] = [
    Column::length("radial_position"),
    Column::length("normal_displacement"),
];

/// Recorded readings of a press.
#[derive(Clone, Debug, PartialEq)]
pub struct PressReadings {
    /// The file, for messages.
    pub(super) file: String,
    /// The line of each marker.
    pub(super) lines: Vec<usize>,
    /// Chart coordinates of each marker on the skin.
    pub(super) places: Vec<[f64; 2]>,
    /// Inward displacement of each marker.
    pub(super) normal: Vec<f64>,
    /// Displacement of each along the skin, if it was sensed.
    pub(super) tangential: Option<Vec<[f64; 2]>>,
    /// The unit that the header states.
    pub(super) unit: Option<LengthUnit>,
}

impl PressReadings {
    /// The unit of lengths that the header states.
    pub fn unit(&self) -> Option<LengthUnit> {
        self.unit
    }

    /// Whether displacements along the skin were sensed.
    pub const fn has_tangential(&self) -> bool {
        self.tangential.is_some()
    }
}

/// Reads a recorded press: one row per marker, with its place on the skin, its normal displacement and, if it was
/// sensed, its displacement along the skin; or with its signed position along a row through the apex and its normal
/// displacement.
///
/// # Errors
/// [`RecordedError`] with file, line, column and value.
pub fn read_press(path: &Path) -> Result<PressReadings, RecordedError> {
    parse_press(RecordedFile::read(path)?)
}

/// The markers of a recorded press, as [`read_press`] reads them.
///
/// # Errors
/// As [`read_press`].
pub fn parse_press(file: RecordedFile) -> Result<PressReadings, RecordedError> {
    let text = file.text()?;
    let any = |start: &str| header(text).iter().any(|name| name.starts_with(start));
    let along_a_row = any("radial_position");
    let with_tangential = !along_a_row && any("tangential");
    let columns = match (along_a_row, with_tangential) {
        (true, _) => &ALONG_A_ROW[..],
        (false, true) => &COLUMNS[..],
        (false, false) => &COLUMNS[..3],
    };
    let sheet = Sheet::parse(&file.name, text, columns)?;
    let file = file.into_name();
    let (mut lines, mut places, mut normal) = (Vec::new(), Vec::new(), Vec::new());
    let mut tangential = Vec::new();
    for (line, numbers) in sheet.rows() {
        lines.push(line);
        match *numbers {
            [position, displacement] => {
                places.push([position, 0.0]);
                normal.push(displacement);
            }
            [x, y, displacement, ref along @ ..] => {
                places.push([x, y]);
                normal.push(displacement);
                if let [along_x, along_y] = *along {
                    tangential.push([along_x, along_y]);
                }
            }
            _ => {}
        }
    }
    Ok(PressReadings {
        unit: sheet.unit,
        file,
        lines,
        places,
        normal,
        tangential: with_tangential.then_some(tangential),
    })
}
