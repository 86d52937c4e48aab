//! Recorded rolls, and the options of their estimate.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use nalgebra::Vector2;
use palpate_ep1::{PadStart, ProbeReading, ReadingNoise};
use palpate_statistics::Number;

use super::RecordedFile;
use super::error::RecordedError;
use super::extra_columns::ExtraColumns;
use super::finger_assignment::parted;
use super::reading_table::{ReadingTable, header};
use super::source::{ReadingSource, finite, same_length};
use super::text_table::TextTable;
use palpate_study::config::{LengthUnit, RollEstimatorConfig, SettingError};
use palpate_study::readings::{Column, QUATERNION, ROLL_SERIES, ROLLS, columns_of};

/// Settings of an estimate that the readings do not state.
#[derive(Clone, Debug, PartialEq)]
pub struct RollOptions {
    /// The probe's radius, in the readings' length unit.
    pub probe_radius: f64,
    /// The estimator.
    pub estimator: RollEstimatorConfig,
    /// The unit of lengths, where the header does not state it.
    pub length_unit: Option<LengthUnit>,
    /// Noise and resolution of the readings, lengths in the same unit. If no noise is stated, standard deviations
    /// follow from the residuals.
    pub noise: ReadingNoise,
}

impl RollOptions {
    /// Options with only the probe's radius stated.
    pub fn new(probe_radius: f64) -> Self {
        Self {
            probe_radius,
            estimator: RollEstimatorConfig::default(),
            length_unit: None,
            noise: ReadingNoise::default(),
        }
    }

    /// Noise of pads on a probe of this radius. Each roll starts at a random place on a pad.
    ///
    /// # Errors
    /// [`SettingError`] for a pitch that a study refuses too: beyond the radius, or below 1e-15 of it.
    pub fn noise_of_pads(probe_radius: f64, pitch: f64) -> Result<ReadingNoise, SettingError> {
        let refuse = |expected: String| Err(SettingError::of_number("pitch", pitch, expected));
        let radius = Number(probe_radius);
        match pitch {
            _ if !(pitch > 0.0 && pitch <= probe_radius) => {
                refuse(format!("> 0 and at most the probe's radius, {radius}"))
            }
            _ if pitch < 1e-15 * probe_radius => {
                refuse("at least 1e-15 of the probe's radius".to_owned())
            }
            _ => Ok(ReadingNoise::of_pads(pitch, PadStart::PerRoll)),
        }
    }

    /// Noise of a sensor without pads, with this standard deviation of each component of a shift.
    ///
    /// # Errors
    /// [`SettingError`] for one beyond the probe's radius, as of a pitch.
    pub fn noise_of_shifts(
        probe_radius: f64,
        shift_std: f64,
    ) -> Result<ReadingNoise, SettingError> {
        if !(0.0..=probe_radius).contains(&shift_std) {
            let radius = Number(probe_radius);
            let expected = format!("at least 0 and at most the probe's radius, {radius}");
            return Err(SettingError::of_number("shift_std", shift_std, expected));
        }
        Ok(ReadingNoise {
            shift_std,
            ..ReadingNoise::default()
        })
    }
}

/// Recorded readings of a roll.
#[derive(Clone, Debug, PartialEq)]
pub struct RollRecording {
    pub(super) origin: ReadingSource,
    /// The probes' numbers in a file; empty for arrays, whose probes are numbered from 0.
    pub(super) probes: Vec<u64>,
    /// Their readings.
    pub(super) readings: Vec<ProbeReading>,
    /// The unit that the header states.
    pub(super) unit: Option<LengthUnit>,
    /// The row of each probe in a file.
    pub(super) rows: Vec<usize>,
    /// Other fields of the file, row by row.
    pub(super) extras: ExtraColumns,
    /// How the rows were assigned to probes, if the file does not name the probes.
    pub(super) note: Option<String>,
}

impl RollRecording {
    /// Readings of probes that turned by `rotations`, whose contacts moved by `shifts`; a third component of a rotation is
    /// the turn about the normal, which moves no contact. Lengths are in `unit`.
    ///
    /// ```
    /// use palpate_recorded::{RollOptions, RollRecording, estimate_roll};
    ///
    /// // A probe of radius 10 that is turned by 0.3 on a ball of radius 20 rolls over 2.
    /// let rotations = [[0.0, -0.3], [0.3, 0.0]];
    /// let readings = RollRecording::new(&rotations, &[[2.0, 0.0], [0.0, 2.0]], None)?;
    /// let estimate = estimate_roll(readings, &RollOptions::new(10.0))?;
    /// assert_eq!(serde_json::to_value(estimate)?["probes"], 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`RecordedError::Array`] for a number that is not finite, and where there are not as many shifts as rotations.
    pub fn new<const D: usize>(
        rotations: &[[f64; D]],
        shifts: &[[f64; 2]],
        unit: Option<LengthUnit>,
    ) -> Result<Self, RecordedError> {
        const { assert!(D == 2 || D == 3) };
        same_length(("shifts", shifts.len()), ("rotations", rotations.len()))?;
        finite("rotations", rotations)?;
        finite("shifts", shifts)?;
        let pairs = rotations.iter().zip(shifts);
        Ok(Self {
            origin: ReadingSource::Arrays,
            probes: Vec::new(),
            readings: pairs
                .map(|(turned, [u, v])| reading(turned[0], turned[1], *u, *v))
                .collect(),
            unit,
            rows: Vec::new(),
            extras: ExtraColumns::default(),
            note: None,
        })
    }

    /// Number of the probe of a reading.
    pub(super) fn probe(&self, reading: usize) -> u64 {
        self.probes.get(reading).copied().unwrap_or(reading as u64)
    }

    /// The unit of lengths that the header states.
    pub fn unit(&self) -> Option<LengthUnit> {
        self.unit
    }
}

/// Reads recorded rolls: one row per probe, or a time series per probe, whose last row counts. The rotation of one row per
/// probe may be a unit quaternion, `qx,qy,qz,qw`, from the start of the roll to its end. Without a column `probe`,
/// each row or series counts as a probe. A new series starts after a blank line or where the time does not increase.
///
/// # Errors
/// [`RecordedError`] with file, line, column and value.
pub fn read_roll(path: &Path) -> Result<RollRecording, RecordedError> {
    parse_roll(RecordedFile::read(path)?)
}

/// Recorded rolls, as [`read_roll`] reads them.
///
/// # Errors
/// Errors of [`read_roll`].
pub fn parse_roll(file: RecordedFile) -> Result<RollRecording, RecordedError> {
    let text = file.table()?;
    let table = TextTable::of(&file, text)?;
    let is_series = is_series(&table)?;
    let header = header(&table, &columns_of("roll"))?;
    let has = |column: &Column| header.has(column);
    let [probe, vector @ .., _, _] = &ROLLS;
    let is_quaternion = !vector.iter().all(has) && QUATERNION.iter().any(has);
    let names_probes = header.has(probe);
    if is_quaternion && let Some(time) = header.time().filter(|_| is_series || !names_probes) {
        let message = format!(
            "column `{time}`: a time series of a roll is not read with quaternions; give one row per roll, with a column `probe` and the rotation from start to end"
        );
        return Err(file.fail(table.header_line, message));
    }
    let of_quaternion = [&[*probe][..], &QUATERNION, &ROLLS[3..]].concat();
    let all = match (is_quaternion, is_series) {
        (true, _) => &of_quaternion[..],
        (false, true) => &ROLL_SERIES[..],
        (false, false) => &ROLLS[..],
    };
    let others = &all[1..];
    let sheet = ReadingTable::read(&table, if names_probes { all } else { others }, &[])?;
    let (probes, note) = match names_probes {
        true => {
            let of_row =
                |(line, numbers): (usize, &[f64])| sheet.index(line, probe.name, numbers[0]);
            let probes: Result<Vec<u64>, _> = sheet.rows().map(of_row).collect();
            (probes?, None)
        }
        false => {
            let (probes, note) = counted(&sheet, is_series);
            (probes, Some(note))
        }
    };
    let rows = sheet
        .rows()
        .zip(&probes)
        .enumerate()
        .map(|(row, ((line, numbers), &probe))| Row {
            row,
            line,
            probe,
            numbers: if names_probes { &numbers[1..] } else { numbers },
        });
    let rows = if is_series && !is_quaternion {
        last_of_each(&sheet, rows)?
    } else {
        one_of_each(&sheet, rows)?
    };
    let (rows, probes, readings) = rows.into_iter().fold(
        (Vec::new(), Vec::new(), Vec::new()),
        |(mut rows, mut probes, mut readings), (row, probe, reading)| {
            rows.push(row);
            probes.push(probe);
            readings.push(reading);
            (rows, probes, readings)
        },
    );
    Ok(RollRecording {
        unit: sheet.unit,
        origin: ReadingSource::File {
            name: sheet.file,
            lines: Vec::new(),
        },
        probes,
        readings,
        rows,
        extras: sheet.extras,
        note,
    })
}

/// Whether a table has time series. If it has the columns of both kinds, the setting `columns` must choose.
fn is_series(table: &TextTable<'_>) -> Result<bool, RecordedError> {
    let header = header(table, &columns_of("roll"))?;
    let has = |column: &Column| header.has(column);
    let is_told = |column: &Column| header.is_told(column);
    let (shifts, pads) = (&ROLLS[3..], &ROLL_SERIES[4..]);
    match (shifts.iter().all(has), pads.iter().all(has)) {
        (true, true) => match (shifts.iter().any(is_told), pads.iter().any(is_told)) {
            (shifts, pads) if shifts != pads => Ok(pads),
            _ => {
                let message = "there are both shift_u, shift_v and pad_u, pad_v; say by setting `columns` which of them are meant, \
                               as in setting `columns` 'shift_u=…,shift_v=…'";
                Err(table.file.fail(table.header_line, message))
            }
        },
        (true, false) => Ok(false),
        (false, true) => Ok(true),
        (false, false) => Ok(pads.iter().any(has) || has(&ROLL_SERIES[1])),
    }
}

/// Probe number of each row of a table without a column `probe`, and a note on how it was found.
fn counted(sheet: &ReadingTable, is_series: bool) -> (Vec<u64>, String) {
    let rows = sheet.lines.len();
    if !is_series {
        let note = format!("no column `probe`: each of the {rows} rows counts as a probe");
        return ((0..rows as u64).collect(), note);
    }
    let times: Vec<f64> = sheet.rows().map(|(_, numbers)| numbers[0]).collect();
    let is_start = |row: &usize| {
        let falls = *row > 0 && times[*row] <= times[*row - 1];
        falls || sheet.after_gaps.contains(row)
    };
    let starts: Vec<usize> = (0..rows).filter(is_start).collect();
    let (parts, count) = parted(rows, &starts);
    let note =
        format!("no column `probe`: {count} are told, by blank lines or by times that do not rise");
    (parts.into_iter().map(|part| part as u64).collect(), note)
}

/// A row of numbers, with the number of its probe.
struct Row<'a> {
    row: usize,
    line: usize,
    probe: u64,
    numbers: &'a [f64],
}

/// Row, probe and reading.
type Taken = (usize, u64, ProbeReading);

fn reading(rotation_x: f64, rotation_y: f64, u: f64, v: f64) -> ProbeReading {
    ProbeReading {
        rotation: Vector2::new(rotation_x, rotation_y),
        shift: Vector2::new(u, v),
    }
}

/// Largest accepted difference of a quaternion's length from 1; a file rounds the components.
const MAX_LENGTH_ERROR: f64 = 1e-3;

/// Rotation vector (x and y, rad) of a unit quaternion `(x, y, z, w)` with scalar part w; at most half a turn.
fn rotation_vector([x, y, z, w]: [f64; 4]) -> Result<[f64; 2], String> {
    let vector = libm::hypot(libm::hypot(x, y), z);
    let length = libm::hypot(vector, w);
    if (length - 1.0).abs() > MAX_LENGTH_ERROR {
        let length = Number::rounded(length);
        return Err(format!(
            "columns `qx` to `qw`: a rotation is a quaternion of length 1, this one has {length}"
        ));
    }
    let angle = 2.0 * libm::atan2(vector, w.abs()).copysign(w);
    let scale = if vector > 0.0 { angle / vector } else { 0.0 };
    Ok([x * scale, y * scale])
}

fn one_of_each<'a>(
    sheet: &ReadingTable,
    rows: impl Iterator<Item = Row<'a>>,
) -> Result<Vec<Taken>, RecordedError> {
    let mut known = HashSet::new();
    let mut taken = Vec::new();
    for Row {
        row,
        line,
        probe,
        numbers,
    } in rows
    {
        let one = match *numbers {
            [x, y, u, v] => reading(x, y, u, v),
            [x, y, z, w, u, v] => {
                let [x, y] =
                    rotation_vector([x, y, z, w]).map_err(|message| sheet.fail(line, message))?;
                reading(x, y, u, v)
            }
            _ => continue,
        };
        if !known.insert(probe) {
            let more = match numbers.len() {
                6 => ": a time series of a roll is not read with quaternions",
                _ => "",
            };
            return Err(sheet.fail(line, format!("probe {probe} stands twice{more}")));
        }
        taken.push((row, probe, one));
    }
    Ok(taken)
}

fn last_of_each<'a>(
    sheet: &ReadingTable,
    rows: impl Iterator<Item = Row<'a>>,
) -> Result<Vec<Taken>, RecordedError> {
    let mut times: HashMap<u64, (usize, f64)> = HashMap::new();
    let mut taken = Vec::new();
    for Row {
        row,
        line,
        probe,
        numbers,
    } in rows
    {
        let &[t_s, x, y, u, v] = numbers else {
            continue;
        };
        let one = (row, probe, reading(x, y, u, v));
        match times.get_mut(&probe) {
            Some((_, before)) if t_s <= *before => {
                let message =
                    format!("column `t_s`: probe {probe} goes from {before} s back to {t_s} s");
                return Err(sheet.fail(line, message));
            }
            Some((place, before)) => {
                *before = t_s;
                taken[*place] = one;
            }
            None => {
                times.insert(probe, (taken.len(), t_s));
                taken.push(one);
            }
        }
    }
    Ok(taken)
}
