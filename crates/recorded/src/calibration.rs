//! Calibration of a camera sensor, from tables or frames with stated displacements.

use palpate_study::config::LengthUnit;
use palpate_study::readings::{Column, Measure};
use palpate_tracking::{
    Calibration, CalibrationError, Change, Equidistant, LateralCalibration, LateralPoint,
    NormalCalibration, NormalFrom, NormalPoint, Track,
};

use super::RecordedFile;
use super::calibration_report::{CalibrationReport, Fitted};
use super::error::RecordedError;
use super::frame_pair::{Frame, track_frames};
use super::header::Header;
use super::reading_table::{ReadingTable, header};
use super::source;
use super::text_table::TextTable;

/// A calibration point, with the number of its measurement series and its line in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Located<P> {
    point: P,
    /// Number of the series in the file; `None` if the file has no column `series`.
    series: Option<u64>,
    line: Option<usize>,
}

/// Calibration points: stated displacements of markers, and the measured changes of these markers' images.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CalibrationPoints {
    file: String,
    unit: Option<LengthUnit>,
    normal: Vec<Located<NormalPoint>>,
    lateral: Vec<Located<LateralPoint>>,
    has_hue: bool,
    has_growth: bool,
    hue_turns: Option<f64>,
}

/// Options of a calibration of a camera sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CalibrateOptions {
    /// Feature of a marker's image (hue, size or both) from which the calibration computes normal displacements.
    pub from: NormalFrom,
    /// Whether a calibrated slope (signal per displacement) is used for each marker separately. A marker without a
    /// slope of its own uses the slope that all markers have in common.
    pub per_marker: bool,
    /// Number of markers in the frame at rest; `None` if there is no such frame.
    pub markers: Option<usize>,
    /// Unit of lengths, used if the headers do not state it.
    pub length_unit: Option<LengthUnit>,
}

const fn column(name: &'static str, measure: Measure) -> Column {
    Column { name, measure }
}

const NORMAL: Column = column("normal_displacement", Measure::Length);
const TANGENTIAL: Column = column("tangential_displacement", Measure::Length);
const HUE: Column = column("hue_turns", Measure::Turn);
const GROWTH: Column = column("growth", Measure::Plain);
const SHIFT: Column = column("centroid_shift_px", Measure::Pixel);
const SERIES: Column = column("series", Measure::Plain);
const MARKER: Column = column("marker", Measure::Plain);
/// Columns of a table from which a camera sensor is calibrated: known displacements and changes of marker images. A
/// file has only some of these columns.
const COLUMNS: [Column; 7] = [NORMAL, TANGENTIAL, HUE, GROWTH, SHIFT, SERIES, MARKER];

/// Largest accepted change of a marker's hue, turns. A larger change is ambiguous: hues that differ by a whole turn are
/// equal.
const MAX_TURN: f64 = 0.5;

/// Reads a table of stated displacements and measured changes of a marker's image. For normal displacements, the
/// columns are `normal_displacement`, and `hue_turns`, `growth` (change of the logarithm of the marker's diameter) or
/// both. For tangential displacements, they are `tangential_displacement` and `centroid_shift_px`. A table may contain
/// both kinds. In addition, the table may contain the columns `series` and `marker`.
///
/// # Errors
/// [`RecordedError`] with file, line, column and value.
impl TryFrom<&RecordedFile> for CalibrationPoints {
    type Error = RecordedError;

    fn try_from(file: &RecordedFile) -> Result<Self, RecordedError> {
        let table = TextTable::of(file, &[])?;
        let columns = columns(&header(&table, &COLUMNS)?);
        let mut sheet = ReadingTable::read(&table, &columns, &[], |_| false)?;
        sheet.first_lost.take().map_or(Ok(()), Err)?;
        let place = |column: Column| columns.iter().position(|one| *one == column);
        let (has_hue, has_growth) = (place(HUE).is_some(), place(GROWTH).is_some());
        let mut points = CalibrationPoints {
            unit: sheet.unit,
            file: sheet.source.name.clone(),
            has_hue,
            has_growth,
            ..CalibrationPoints::default()
        };
        for (line, numbers) in sheet.rows() {
            let of = |column: Column| place(column).map(|place| numbers[place]);
            let index = |column: Column| {
                let number = of(column);
                let index = number.map(|number| sheet.index(line, column.name, number));
                index.transpose()
            };
            if let Some(hue) = of(HUE).filter(|hue| hue.abs() > MAX_TURN) {
                let message = format!(
                    "column `{}`: a change of hue must be between -{MAX_TURN} and {MAX_TURN} turns, is {hue}: is it in degrees?",
                    HUE.name
                );
                return Err(sheet.fail(line, message));
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
                points.normal.push(Located {
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
                points.lateral.push(Located {
                    point,
                    series,
                    line,
                });
            }
        }
        Ok(points)
    }
}

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
    columns.extend([HUE, GROWTH].into_iter().filter(|&column| has(column)));
    // If the header contains neither the hue nor the growth, report the hue as the missing column, because it is the
    // most common feature.
    if !is_lateral && !has(HUE) && !has(GROWTH) {
        columns.push(HUE);
    }
    columns.extend([SERIES, MARKER].into_iter().filter(|&column| has(column)));
    columns
}

/// Stated displacements of the marker under the contact, one for each pressed frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KnownDisplacements {
    /// Displacement of the marker into the skin in each pressed frame (length); `None` if it is not stated.
    pub normal: Option<Vec<f64>>,
    /// Displacement of the marker along the skin in each pressed frame (length); `None` if it is not stated. Only the
    /// magnitudes are used.
    pub tangential: Option<Vec<f64>>,
    /// Feature of a marker's image from which normal displacements are computed. If normal displacements are stated,
    /// the marker with the largest change of this feature is assumed to be under the contact.
    pub from: NormalFrom,
    /// Scale of the camera, pixels per radian. If it is `None`, shifts in px are not corrected for the lens.
    pub px_per_rad: Option<f64>,
}

/// Returns the calibration points that were measured in frames, and the number of markers in the frame at rest.
///
/// # Errors
/// [`RecordedError::Readings`] if a frame has no markers, has another size than the frame at rest or comes from another
/// sensor. The same error if there are fewer displacements than pressed frames, or if the scale of the camera is
/// invalid.
pub fn frame_calibration_points(
    rest: &Frame,
    pressed: &[Frame],
    known: &KnownDisplacements,
) -> Result<(CalibrationPoints, usize), RecordedError> {
    let last = pressed.last().map_or("", |frame| &frame.file);
    let mut points = CalibrationPoints {
        file: format!("{} to {last}", rest.file),
        has_hue: true,
        has_growth: true,
        ..CalibrationPoints::default()
    };
    let mut markers = 0;
    for (index, frame) in pressed.iter().enumerate() {
        let refused = |message: String| RecordedError::readings(&frame.file, message);
        let frames = track_frames(rest, frame)?;
        frames.of_one_sensor()?;
        markers = frames.at_rest();
        points.hue_turns = Some(frames.hue_at_rest());
        let lens = known
            .px_per_rad
            .map(|px_per_rad| Equidistant::new(frames.centre_px, px_per_rad, [0.0; 2]))
            .transpose()
            .map_err(|error| refused(error.to_string()))?;
        let change = |track: &Track| match &lens {
            Some(lens) => lens.change(track),
            None => track.change(),
        };
        let strength = |track: &Track| change(track).map(|change| strength(&change, known));
        let (marker, _) = frames.strongest(strength).ok_or_else(|| {
            refused("no marker of the frame at rest was found in the pressed frame".to_owned())
        })?;
        let change = change(&frames.tracks[marker]).unwrap_or_default();
        let of_frame = |numbers: &Option<Vec<f64>>| match numbers {
            None => Ok(None),
            Some(numbers) => match numbers.get(index) {
                Some(number) => Ok(Some(*number)),
                None => {
                    let (number, count) = (index + 1, numbers.len());
                    let message = format!(
                        "is pressed frame {number}, but only {count} displacements are given"
                    );
                    Err(refused(message))
                }
            },
        };
        let inward = of_frame(&known.normal)?;
        if let Some(inward) = inward {
            points.normal.push(located(NormalPoint {
                marker: Some(marker),
                normal: inward,
                hue_turns: change.hue_turns,
                growth: change.growth,
            }));
        }
        if let Some(along) = of_frame(&known.tangential)? {
            points.lateral.push(located(LateralPoint {
                tangential: [along.abs(), 0.0],
                shift_px: [libm::hypot(change.shift_px[0], change.shift_px[1]), 0.0],
                normal: inward,
            }));
        }
    }
    Ok((points, markers))
}

const fn located<P>(point: P) -> Located<P> {
    Located {
        point,
        series: None,
        line: None,
    }
}

/// Change of the feature (shift, hue or size of a marker's image) by which the calibration finds the marker under the
/// contact. The marker with the largest change is assumed to be under the contact.
fn strength(change: &Change, known: &KnownDisplacements) -> f64 {
    match (&known.normal, known.from) {
        (None, _) => libm::hypot(change.shift_px[0], change.shift_px[1]),
        (Some(_), NormalFrom::Hue) => change.hue_turns,
        (Some(_), NormalFrom::Size | NormalFrom::Both) => change.growth,
    }
}

/// Calibrates a sensor by a fit to the calibration points of all files together.
///
/// # Errors
/// [`RecordedError::Line`] if a point of a file is wrong. [`RecordedError::Readings`] if the files contradict each
/// other or the options, or if the points do not determine a slope.
pub fn calibrate(
    points: &[CalibrationPoints],
    options: &CalibrateOptions,
) -> Result<CalibrationReport, RecordedError> {
    let length_unit = agreed_unit(points, options)?;
    let normal = Pooled::of(points, |points| &points.normal);
    let lateral = Pooled::of(points, |points| &points.lateral);
    if !normal.points.is_empty() {
        check_features(points, options.from)?;
    }
    let of_normal = |points: &[NormalPoint]| NormalCalibration::fit(points, options.from);
    let has_normal = !normal.points.is_empty() || lateral.points.is_empty();
    let normal_part = has_normal.then(|| of_normal(&normal.points)).transpose();
    let mut normal_part = normal_part.map_err(|error| normal.refused(points, &error))?;
    if options.per_marker {
        normal_part = normal_part.map(NormalCalibration::per_marker);
    }
    let has_lateral = !lateral.points.is_empty();
    let lateral_part = has_lateral.then(|| LateralCalibration::fit(&lateral.points));
    let lateral_part = lateral_part.transpose();
    let lateral_part = lateral_part.map_err(|error| lateral.refused(points, &error))?;
    let all = Calibration::new(normal_part, lateral_part, options.markers);
    let mut calibration = all.map_err(|error| normal.refused(points, &error))?;
    calibration.hue_turns = points.iter().find_map(|points| points.hue_turns);
    Ok(CalibrationReport {
        calibration,
        length_unit,
        copies: copies(&normal, &lateral),
        normal: normal.series(|points| of_normal(points).map(|part| Fitted::normal(&part))),
        lateral: lateral
            .series(|points| LateralCalibration::fit(points).map(|part| Fitted::lateral(&part))),
    })
}

/// Number of calibration points that repeat an earlier point. Points of normal and points of tangential displacements
/// are counted separately, and the larger count is returned. A count is 0 if less than half of its points are repeated.
fn copies(normal: &Pooled<'_, NormalPoint>, lateral: &Pooled<'_, LateralPoint>) -> usize {
    let of_normal = normal.copies(|point| {
        let marker = point.marker.map_or(0.0, |marker| marker as f64);
        [point.normal, point.hue_turns, point.growth, 0.0, marker]
    });
    let of_lateral = lateral.copies(|point| {
        let ([along, _], [x, y]) = (point.tangential, point.shift_px);
        [along, x, y, point.normal.unwrap_or(0.0), 0.0]
    });
    of_normal.max(of_lateral)
}

/// Unit of lengths that the headers of the files or the setting `length_unit` state. Different units are an error.
fn agreed_unit(
    points: &[CalibrationPoints],
    options: &CalibrateOptions,
) -> Result<LengthUnit, RecordedError> {
    let option = options.length_unit;
    let mut stated = option.map(|unit| (unit, "setting `length_unit`"));
    for CalibrationPoints { file, unit, .. } in points {
        let Some(unit) = *unit else { continue };
        let (before, source) = *stated.get_or_insert((unit, file));
        if unit != before {
            let (unit, before) = (unit.as_str(), before.as_str());
            let message = format!("the header says {unit}, {source} says {before}");
            return Err(RecordedError::readings(file, message));
        }
    }
    Ok(stated.map(|(unit, _)| unit).unwrap_or_default())
}

fn check_features(points: &[CalibrationPoints], from: NormalFrom) -> Result<(), RecordedError> {
    for one in points.iter().filter(|one| !one.normal.is_empty()) {
        let missing = match from {
            NormalFrom::Hue | NormalFrom::Both if !one.has_hue => HUE.name,
            NormalFrom::Size | NormalFrom::Both if !one.has_growth => GROWTH.name,
            _ => continue,
        };
        let from: &str = from.into();
        let message = format!("no column `{missing}`; setting `from` {from} needs it");
        return Err(RecordedError::readings(&one.file, message));
    }
    Ok(())
}

struct Pooled<'a, P> {
    points: Vec<P>,
    /// For each point: the name of the file, the number of the series (`None` if the file has no series), and the line
    /// in the file (`None` if the point was measured in frames).
    sources: Vec<(&'a str, Option<u64>, Option<usize>)>,
}

impl<'a, P: Copy + 'a> Pooled<'a, P> {
    fn of(
        files: &'a [CalibrationPoints],
        part: impl Fn(&'a CalibrationPoints) -> &'a Vec<Located<P>>,
    ) -> Self {
        let located = |file: &'a CalibrationPoints| {
            let all = part(file).iter();
            all.map(|one| (one.point, (file.file.as_str(), one.series, one.line)))
        };
        let (points, sources) = files.iter().flat_map(located).unzip();
        Self { points, sources }
    }

    /// Number of points that repeat an earlier point of the same series. `numbers` returns the values of a point that
    /// are compared. Points at rest, whose first four values are 0, are not counted. The result is 0 if less than half
    /// of all points are repeated.
    fn copies(&self, numbers: impl Fn(&P) -> [f64; 5]) -> usize {
        let all = self.points.iter().zip(&self.sources);
        let moved = all.filter_map(|(point, (_, series, _))| {
            let [a, b, c, d, e] = numbers(point);
            let is_moved = [a, b, c, d].iter().any(|number| *number != 0.0);
            let series = series.map_or(-1.0, |series| series as f64);
            is_moved.then_some([a, b, c, d, e, series])
        });
        let count = source::copies(moved).len();
        if 2 * count >= self.points.len() {
            count
        } else {
            0
        }
    }

    /// Calls `fit` with the points of each series. Returns the name and the result of each series, in order of first
    /// appearance. Returns an empty list if there is only one series.
    fn series(
        &self,
        fit: impl Fn(&[P]) -> Result<Fitted, CalibrationError>,
    ) -> Vec<(String, Result<Fitted, CalibrationError>)> {
        let mut series: Vec<(&str, Option<u64>)> = Vec::new();
        for &(file, number, _) in &self.sources {
            if !series.contains(&(file, number)) {
                series.push((file, number));
            }
        }
        if series.len() < 2 {
            return Vec::new();
        }
        let has_one_file = self.sources.iter().all(|one| one.0 == self.sources[0].0);
        let fitted = |&(file, number): &(&str, Option<u64>)| {
            let all = self.sources.iter().zip(&self.points);
            let of_series = all.filter(|(source, _)| (source.0, source.1) == (file, number));
            let points: Vec<P> = of_series.map(|(_, point)| *point).collect();
            let name = match number {
                Some(number) if has_one_file => format!("series {number}"),
                Some(number) => format!("{file} series {number}"),
                None => file.to_owned(),
            };
            (name, fit(&points))
        };
        series.iter().map(fitted).collect()
    }

    fn refused(&self, all: &[CalibrationPoints], error: &CalibrationError) -> RecordedError {
        if let CalibrationError::NotFinite { point } = error
            && let Some((file, _, Some(line))) = self.sources.get(*point)
        {
            return RecordedError::line(file, *line, "a number is beyond 1e100");
        }
        let mut files: Vec<&str> = self.sources.iter().map(|source| source.0).collect();
        files.dedup();
        if files.is_empty() {
            files = all.iter().map(|points| points.file.as_str()).collect();
        }
        RecordedError::readings(files.join(", "), error.to_string())
    }
}
