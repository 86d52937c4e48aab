//! Calibration of a camera sensor from tables of known displacements.

use std::collections::HashSet;
use std::path::Path;

use palpate_tracking::{
    Calibration, CalibrationError, LateralCalibration, LateralPoint, NormalCalibration, NormalFrom,
    NormalPoint,
};

use super::RecordedFile;
use super::calibration_report::{CalibrationReport, Fitted};
use super::error::RecordedError;
use super::header::Header;
use super::reading_table::{ReadingTable, header};
use super::text_table::TextTable;
use palpate_study::config::LengthUnit;
use palpate_study::readings::{CALIBRATIONS, Column};

/// A point of a calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Known<P> {
    point: P,
    /// Series in the file; `None` if the file names no series.
    series: Option<u64>,
    /// The line of the file.
    line: Option<usize>,
}

/// Known displacements, and the measured changes of the markers' pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationPoints {
    /// The file, for messages.
    file: String,
    unit: Option<LengthUnit>,
    normal: Vec<Known<NormalPoint>>,
    lateral: Vec<Known<LateralPoint>>,
    has_hue: bool,
    has_growth: bool,
}

/// How to calibrate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CalibrateOptions {
    /// Feature of a marker's picture from which normal displacements are computed.
    pub from: NormalFrom,
    /// Whether to use a marker's own slope if it has one.
    pub per_marker: bool,
    /// Number of markers that the sensor shows at rest, if known.
    pub markers: Option<usize>,
    /// The unit of lengths, where the headers do not state it.
    pub length_unit: Option<LengthUnit>,
}

const NORMAL: Column = CALIBRATIONS[0];
const TANGENTIAL: Column = CALIBRATIONS[1];
const HUE: Column = CALIBRATIONS[2];
const GROWTH: Column = CALIBRATIONS[3];
const SHIFT: Column = CALIBRATIONS[4];
const SERIES: Column = CALIBRATIONS[5];
const MARKER: Column = CALIBRATIONS[6];

/// Largest change of hue, turns. Whole turns cannot be distinguished.
const LARGEST_TURN: f64 = 0.5;

impl CalibrationPoints {
    /// Points measured in frames; messages name them `source`.
    pub fn shown(source: String, normal: &[NormalPoint], lateral: &[LateralPoint]) -> Self {
        fn known<P: Copy>(points: &[P]) -> Vec<Known<P>> {
            let known = |point: &P| Known {
                point: *point,
                series: None,
                line: None,
            };
            points.iter().map(known).collect()
        }
        Self {
            file: source,
            unit: None,
            normal: known(normal),
            lateral: known(lateral),
            has_hue: true,
            has_growth: true,
        }
    }
}

/// Reads a table of known displacements: `normal_displacement` with `hue_turns`, `growth` (change of the logarithm of
/// the marker's diameter) or both, `tangential_displacement` with `centroid_shift_px`, or all of these. The columns
/// `series` and `marker` are optional.
///
/// # Errors
/// [`RecordedError`] with file, line, column and value.
pub fn read_calibration_points(path: &Path) -> Result<CalibrationPoints, RecordedError> {
    parse_calibration_points(&RecordedFile::read(path)?)
}

/// Known displacements, as [`read_calibration_points`] reads them.
///
/// # Errors
/// Errors of [`read_calibration_points`].
pub fn parse_calibration_points(file: &RecordedFile) -> Result<CalibrationPoints, RecordedError> {
    let text = file.table()?;
    let table = TextTable::of(file, text)?;
    let columns = columns(&header(&table, &CALIBRATIONS)?);
    let sheet = ReadingTable::read(&table, &columns, &[])?;
    let place = |column: Column| columns.iter().position(|one| *one == column);
    let has_hue = place(HUE).is_some();
    let has_growth = place(GROWTH).is_some();
    let mut points = CalibrationPoints {
        unit: sheet.unit,
        file: sheet.file.clone(),
        normal: Vec::new(),
        lateral: Vec::new(),
        has_hue,
        has_growth,
    };
    for (line, numbers) in sheet.rows() {
        let of = |column: Column| place(column).map(|place| numbers[place]);
        let index = |column: Column| {
            let number = of(column);
            number
                .map(|number| sheet.index(line, column.name, number))
                .transpose()
        };
        if let Some(hue) = of(HUE).filter(|hue| hue.abs() > LARGEST_TURN) {
            return Err(RecordedError::Line {
                file: sheet.file.clone(),
                line,
                message: format!(
                    "column `{}`: a change of hue must be between -{LARGEST_TURN} and {LARGEST_TURN} turns, is {hue}: is it in degrees?",
                    HUE.name
                ),
            });
        }
        let (series, line) = (index(SERIES)?, Some(line));
        let marker = index(MARKER)?.map(|marker| marker as usize);
        let normal = of(NORMAL);
        if let Some(normal) = normal.filter(|_| has_hue || has_growth) {
            let point = NormalPoint {
                marker,
                normal,
                hue_turns: of(HUE).unwrap_or(0.0),
                growth: of(GROWTH).unwrap_or(0.0),
            };
            points.normal.push(Known {
                point,
                series,
                line,
            });
        }
        if let Some((tangential, shift)) = of(TANGENTIAL).zip(of(SHIFT)) {
            let point = LateralPoint {
                tangential: [tangential, 0.0],
                shift_px: [shift, 0.0],
                normal,
            };
            points.lateral.push(Known {
                point,
                series,
                line,
            });
        }
    }
    Ok(points)
}

/// The columns to read, chosen by the names in the header.
fn columns(header: &Header<'_>) -> Vec<Column> {
    let has = |column: Column| header.has(&column);
    let mut columns = Vec::new();
    if has(TANGENTIAL) || has(SHIFT) {
        columns.extend([TANGENTIAL, SHIFT]);
    }
    let is_lateral = !columns.is_empty();
    if has(NORMAL) || has(HUE) || has(GROWTH) || !is_lateral {
        columns.push(NORMAL);
    }
    let sights = [HUE, GROWTH].into_iter().filter(|&column| has(column));
    columns.extend(sights);
    // If the header names no feature, require the hue, which is the most common.
    if !is_lateral && !has(HUE) && !has(GROWTH) {
        columns.push(HUE);
    }
    let names_of = [SERIES, MARKER].into_iter().filter(|&column| has(column));
    columns.extend(names_of);
    columns
}

/// Calibrates a sensor to all points together.
///
/// # Errors
/// [`RecordedError::Line`] if one point is at fault; otherwise [`RecordedError::Readings`]: the files contradict each
/// other or the options, or the points determine no slope.
pub fn calibrate(
    points: &[CalibrationPoints],
    options: &CalibrateOptions,
) -> Result<CalibrationReport, RecordedError> {
    let length_unit = agreed_units(points, options)?;
    let normal = Pooled::of(points, |points| &points.normal);
    let lateral = Pooled::of(points, |points| &points.lateral);
    if !normal.points.is_empty() {
        shows(points, options)?;
    }
    let of_normal = |points: &[NormalPoint]| NormalCalibration::fit(points, options.from);
    let normal_part = (!normal.points.is_empty() || lateral.points.is_empty())
        .then(|| of_normal(&normal.points).map_err(|error| normal.refused(points, &error)))
        .transpose()?
        .map(|part| {
            if options.per_marker {
                part.per_marker()
            } else {
                part
            }
        });
    let lateral_part = (!lateral.points.is_empty())
        .then(|| {
            LateralCalibration::fit(&lateral.points)
                .map_err(|error| lateral.refused(points, &error))
        })
        .transpose()?;
    let all = Calibration::new(normal_part, lateral_part, options.markers);
    let calibration = all.map_err(|error| normal.refused(points, &error))?;
    Ok(CalibrationReport {
        copies: copies(&normal, &lateral),
        calibration,
        length_unit,
        normal: normal.series(|points| {
            let part = of_normal(points)?;
            Ok(Fitted {
                through_rest: part.line,
                with_intercept: part.with_intercept,
            })
        }),
        lateral: lateral.series(|points| {
            let part = LateralCalibration::fit(points)?;
            Ok(Fitted {
                through_rest: part.line,
                with_intercept: part.with_intercept,
            })
        }),
    })
}

/// Number of points that repeat an earlier one, for the kind with more of them; 0 if under half of each kind repeat.
fn copies(normal: &Pooled<NormalPoint>, lateral: &Pooled<LateralPoint>) -> usize {
    let of_normal = normal.copies(|point| {
        let marker = point.marker.map_or(-1.0, |marker| marker as f64);
        [marker, point.normal, point.hue_turns, point.growth]
    });
    let of_lateral = lateral.copies(|point| {
        let ([along, across], [x, y]) = (point.tangential, point.shift_px);
        [along, across, x, y, point.normal.unwrap_or(0.0)]
    });
    let all = [
        (of_normal, normal.points.len()),
        (of_lateral, lateral.points.len()),
    ];
    let many = all
        .into_iter()
        .filter(|(copies, points)| 2 * copies >= *points);
    many.map(|(copies, _)| copies).max().unwrap_or(0)
}

/// The unit that headers or the setting `length_unit` state.
fn agreed_units(
    points: &[CalibrationPoints],
    options: &CalibrateOptions,
) -> Result<LengthUnit, RecordedError> {
    let mut stated = options
        .length_unit
        .map(|unit| (unit, "setting `length_unit`"));
    for CalibrationPoints { file, unit, .. } in points {
        match (*unit, stated) {
            (Some(unit), Some((before, source))) if unit != before => {
                let (unit, before) = (unit.as_str(), before.as_str());
                return Err(RecordedError::Readings {
                    file: file.clone(),
                    message: format!("the header says {unit}, {source} says {before}"),
                });
            }
            (Some(unit), None) => stated = Some((unit, file)),
            _ => {}
        }
    }
    Ok(stated.map(|(unit, _)| unit).unwrap_or_default())
}

/// Rejects files without the columns that `options.from` needs.
fn shows(points: &[CalibrationPoints], options: &CalibrateOptions) -> Result<(), RecordedError> {
    let from = options.from;
    let needs_hue = matches!(from, NormalFrom::Hue | NormalFrom::Both);
    let needs_growth = matches!(from, NormalFrom::Size | NormalFrom::Both);
    for one in points.iter().filter(|one| !one.normal.is_empty()) {
        for (column, is_needed, is_there) in [
            (HUE.name, needs_hue, one.has_hue),
            (GROWTH.name, needs_growth, one.has_growth),
        ] {
            if is_needed && !is_there {
                return Err(RecordedError::Readings {
                    file: one.file.clone(),
                    message: format!(
                        "no column `{column}`; setting `from` {} needs it",
                        from.name()
                    ),
                });
            }
        }
    }
    Ok(())
}

/// The points of all files.
struct Pooled<P> {
    points: Vec<P>,
    /// File index, series and line of each point.
    sources: Vec<(usize, Option<u64>, Option<usize>)>,
    files: Vec<String>,
}

impl<P: Copy> Pooled<P> {
    /// Number of points, except those at rest, whose `numbers` repeat an earlier point of the same series.
    fn copies<const N: usize>(&self, numbers: impl Fn(&P) -> [f64; N]) -> usize {
        let mut known = HashSet::new();
        let points = self.points.iter().zip(&self.sources);
        let is_again = |(point, (_, series, _)): &(&P, &(usize, Option<u64>, Option<usize>))| {
            let numbers = numbers(point);
            let is_at_rest = numbers.iter().all(|number| *number == 0.0);
            !is_at_rest && !known.insert((*series, numbers.map(f64::to_bits)))
        };
        points.filter(is_again).count()
    }

    fn of(
        files: &[CalibrationPoints],
        part: impl Fn(&CalibrationPoints) -> &Vec<Known<P>>,
    ) -> Self {
        let mut pooled = Self {
            points: Vec::new(),
            sources: Vec::new(),
            files: Vec::new(),
        };
        for file in files.iter().filter(|file| !part(file).is_empty()) {
            for known in part(file) {
                pooled.points.push(known.point);
                let source = (pooled.files.len(), known.series, known.line);
                pooled.sources.push(source);
            }
            pooled.files.push(file.file.clone());
        }
        pooled
    }

    /// Result of `fit` for each series, if there are several, in the order in which they appear.
    fn series<F>(
        &self,
        fit: impl Fn(&[P]) -> Result<F, CalibrationError>,
    ) -> Vec<(String, Result<F, CalibrationError>)> {
        let mut names: Vec<(usize, Option<u64>)> = Vec::new();
        for &(file, series, _) in &self.sources {
            if !names.contains(&(file, series)) {
                names.push((file, series));
            }
        }
        if names.len() < 2 {
            return Vec::new();
        }
        let fitted = |&(file, series): &(usize, Option<u64>)| {
            let of_series = self.sources.iter().zip(&self.points);
            let points: Vec<P> = of_series
                .filter(|(source, _)| (source.0, source.1) == (file, series))
                .map(|(_, point)| *point)
                .collect();
            let name = match (series, self.files.len()) {
                (Some(series), 1) => format!("series {series}"),
                (Some(series), _) => format!("{} series {series}", self.files[file]),
                (None, _) => self.files[file].clone(),
            };
            (name, fit(&points))
        };
        names.iter().map(fitted).collect()
    }

    /// The error with the file and the line that is at fault.
    fn refused(&self, all: &[CalibrationPoints], error: &CalibrationError) -> RecordedError {
        let message = error.to_string();
        if let CalibrationError::NotFinite { point } = error
            && let Some((file, _, Some(line))) = self.sources.get(*point)
        {
            return RecordedError::Line {
                file: self.files[*file].clone(),
                line: *line,
                message: "a number is beyond 1e100".to_owned(),
            };
        }
        let files: Vec<&str> = if self.files.is_empty() {
            all.iter().map(|points| points.file.as_str()).collect()
        } else {
            self.files.iter().map(String::as_str).collect()
        };
        RecordedError::Readings {
            file: files.join(", "),
            message,
        }
    }
}
