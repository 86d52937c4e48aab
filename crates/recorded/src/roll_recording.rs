//! Recorded rolls.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use nalgebra::Vector2;
use palpate_ep1::ProbeReading;
use palpate_statistics::Number;
use palpate_study::config::LengthUnit;
use palpate_study::readings::{Column, QUATERNION, ROLL_SERIES, ROLLS, columns_of};

use super::RecordedFile;
use super::error::RecordedError;
use super::finger_assignment::parted;
use super::header::Header;
use super::reading_table::{ExtraColumns, ReadingTable, header};
use super::source::{ReadingSource, copies, finite, same_length};
use super::text_table::TextTable;

/// Largest number of rolls that are compared with each other directly.
const MAX_COMPARED: usize = 32;

/// Recorded readings of a roll.
#[derive(Clone, Debug, PartialEq)]
pub struct RollRecording {
    pub(super) source: ReadingSource,
    /// The probes' numbers in a file; empty for arrays, whose probes are numbered from 0.
    pub(super) probes: Vec<u64>,
    /// Their readings.
    pub(super) readings: Vec<ProbeReading>,
    /// The unit of lengths that the header states.
    pub unit: Option<LengthUnit>,
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
    /// [`RecordedError::Array`] for a number that is not finite, and for a different number of shifts and rotations.
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
            source: ReadingSource::arrays(),
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

    /// Leaves out rolls that repeat earlier ones, and returns a warning, if they are at least half of the rolls. All are kept
    /// if rolls by equal rotations have different shifts: then coarse sensors may cause the repetitions.
    pub(super) fn leave_out_copies(&mut self) -> Option<String> {
        let readings = &self.readings;
        let is_repeated = |(place, one)| readings[..place].contains(one);
        // Few rolls are compared without a table, because that takes longer than their estimate.
        if readings.len() <= MAX_COMPARED && !readings.iter().enumerate().any(is_repeated) {
            return None;
        }
        let mut shifts = HashMap::new();
        let repeats = |reading: &ProbeReading| {
            let bits = |numbers: Vector2<f64>| numbers.map(|number| (number + 0.0).to_bits());
            let first = shifts.entry(bits(reading.rotation));
            *first.or_insert(reading.shift) == reading.shift
        };
        if !readings.iter().all(repeats) {
            return None;
        }
        let rolls = readings.iter().map(|reading| {
            let ([x, y], [u, v]) = (reading.rotation.into(), reading.shift.into());
            [x, y, u, v]
        });
        let text = self.source.repeated("roll", rolls.clone(), 0.5)?;
        let mut copied = copies(rolls).into_iter().peekable();
        let kept = (0..readings.len()).filter(|roll| copied.next_if_eq(roll).is_none());
        let kept: Vec<usize> = kept.collect();
        if kept.len() < 2 {
            return None;
        }
        self.readings = kept.iter().map(|&roll| self.readings[roll]).collect();
        let rows = kept.iter().filter_map(|&roll| self.rows.get(roll).copied());
        self.rows = rows.collect();
        let probes = kept.iter().map(|&roll| self.probe(roll));
        self.probes = probes.collect();
        Some(text)
    }

    /// Number of the probe of a reading.
    pub(super) fn probe(&self, reading: usize) -> u64 {
        self.probes.get(reading).copied().unwrap_or(reading as u64)
    }
}

/// Reads recorded rolls: one row per probe, or a time series per probe, whose last row counts. The rotation of one row per
/// probe may be a unit quaternion, `qx,qy,qz,qw`, from the start of the roll to its end. Without a column `probe`,
/// each row or series counts as a probe. A new series starts after a blank line or where the time does not increase.
///
/// # Errors
/// [`RecordedError`] with file, line, column and value.
pub fn parse_roll(file: RecordedFile) -> Result<RollRecording, RecordedError> {
    let table = TextTable::of(&file)?;
    let header = header(&table, &columns_of("roll"))?;
    let fail = |message: String| Err(file.fail(table.header_line, message));
    let is_series = match is_series(&header) {
        Ok(is_series) => is_series,
        Err(message) => return fail(message),
    };
    let has = |column: &Column| header.has(column);
    let [probe, vector @ .., _, _] = &ROLLS;
    let is_quaternion = !vector.iter().all(has) && QUATERNION.iter().any(has);
    let names_probes = has(probe);
    if is_quaternion && let Some(time) = header.time().filter(|_| is_series || !names_probes) {
        return fail(format!(
            "column `{time}`: a time series of a roll is not read with quaternions; give one row per roll, with a column `probe` and the rotation from start to end"
        ));
    }
    let of_quaternion = [&[*probe][..], &QUATERNION, &ROLLS[3..]].concat();
    let columns = match (is_quaternion, is_series) {
        (true, _) => &of_quaternion[..],
        (false, true) => &ROLL_SERIES[..],
        (false, false) => &ROLLS[..],
    };
    let first = usize::from(names_probes);
    let sheet = ReadingTable::read(&table, &columns[1 - first..], &[])?;
    let (probes, note) = match names_probes {
        true => {
            let rows = sheet.rows();
            let index = rows.map(|(line, numbers)| sheet.index(line, probe.name, numbers[0]));
            (index.collect::<Result<Vec<u64>, _>>()?, None)
        }
        false => {
            let (probes, note) = counted(&sheet, is_series);
            (probes, Some(note))
        }
    };
    let mut recording = RollRecording {
        unit: sheet.unit,
        probes: Vec::new(),
        readings: Vec::new(),
        rows: Vec::new(),
        note,
        ..RollRecording::new::<2>(&[], &[], None)?
    };
    // Position and last time of each probe.
    let mut earlier: HashMap<u64, (usize, f64)> = HashMap::new();
    for (row, ((line, numbers), &probe)) in sheet.rows().zip(&probes).enumerate() {
        let (time, one) = match numbers[first..] {
            [x, y, u, v] => (None, reading(x, y, u, v)),
            [t_s, x, y, u, v] => (Some(t_s), reading(x, y, u, v)),
            [x, y, z, w, u, v] => {
                let rotation = rotation_vector([x, y, z, w]);
                let [x, y] = rotation.map_err(|message| sheet.fail(line, message))?;
                (None, reading(x, y, u, v))
            }
            _ => continue,
        };
        match (earlier.entry(probe), time) {
            (Entry::Vacant(entry), _) => {
                entry.insert((recording.rows.len(), time.unwrap_or_default()));
                recording.rows.push(row);
                recording.probes.push(probe);
                recording.readings.push(one);
            }
            (Entry::Occupied(mut entry), Some(t_s)) => {
                let (place, before) = *entry.get();
                if t_s <= before {
                    let message =
                        format!("column `t_s`: probe {probe} goes from {before} s back to {t_s} s");
                    return Err(sheet.fail(line, message));
                }
                entry.insert((place, t_s));
                recording.rows[place] = row;
                recording.readings[place] = one;
            }
            (Entry::Occupied(_), None) => {
                let more = match is_quaternion {
                    true => ": a time series of a roll is not read with quaternions",
                    false => "",
                };
                return Err(sheet.fail(line, format!("probe {probe} occurs twice{more}")));
            }
        }
    }
    recording.source.name = sheet.source.name;
    recording.extras = sheet.extras;
    Ok(recording)
}

/// Whether a table has time series. If it has the columns of both kinds, the setting `columns` must choose.
fn is_series(header: &Header<'_>) -> Result<bool, String> {
    let has = |column: &Column| header.has(column);
    let (shifts, pads) = (&ROLLS[3..], &ROLL_SERIES[4..]);
    match (shifts.iter().all(has), pads.iter().all(has)) {
        (true, true) => match (header.is_assigned(shifts), header.is_assigned(pads)) {
            (shifts, pads) if shifts != pads => Ok(pads),
            _ => Err("there are both shift_u, shift_v and pad_u, pad_v; state which to read, as in setting `columns` 'shift_u=…,shift_v=…'".to_owned()),
        },
        (true, false) => Ok(false),
        (false, true) => Ok(true),
        (false, false) => Ok(pads.iter().any(has) || has(&ROLL_SERIES[1])),
    }
}

/// Probe number of each row of a table without a column `probe`, and a note on how it was found.
fn counted(sheet: &ReadingTable, is_series: bool) -> (Vec<u64>, String) {
    let rows = sheet.source.lines.len();
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
    let note = format!(
        "no column `probe`: blank lines, or times that do not increase, separate {count} probes"
    );
    (parts.into_iter().map(|part| part as u64).collect(), note)
}

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
