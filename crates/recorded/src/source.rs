//! The source of readings (a file or arrays), which is named in messages.

use std::collections::HashSet;

use palpate_statistics::Number;
use palpate_study::Warning;
use palpate_study::config::LengthUnit;

use super::error::RecordedError;

/// Source of readings: a file with the line of each reading, or the arrays of a program, which have no lines.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ReadingSource {
    pub(super) name: String,
    pub(super) lines: Vec<usize>,
    /// Row (from 0) of each reading in the file. If the list is empty, the index of a reading is its row.
    pub(super) rows: Vec<usize>,
    /// Warnings about columns of the file that were not found by their names, or that are not read.
    pub(super) notes: Vec<Warning>,
}

impl ReadingSource {
    pub(super) fn arrays() -> Self {
        Self::new("readings", Vec::new())
    }

    pub(super) fn new(name: &str, lines: Vec<usize>) -> Self {
        Self {
            name: name.to_owned(),
            lines,
            rows: Vec::new(),
            notes: Vec::new(),
        }
    }

    pub(super) fn line(&self, reading: usize) -> Option<usize> {
        self.lines.get(reading).copied()
    }

    pub(super) fn row_number(&self, reading: usize) -> usize {
        self.rows.get(reading).copied().unwrap_or(reading) + 1
    }

    pub(super) fn row(&self, reading: usize) -> String {
        let line = self.line(reading);
        let line = line.map_or(String::new(), |line| format!(", line {line}"));
        format!("row {}{line}", self.row_number(reading))
    }

    pub(super) fn selected(&self, rows: &[usize]) -> Self {
        let lines = rows.iter().filter_map(|&row| self.line(row)).collect();
        Self {
            name: self.name.clone(),
            lines,
            rows: rows.iter().map(|&row| self.row_number(row) - 1).collect(),
            notes: self.notes.clone(),
        }
    }

    pub(super) fn fail(&self, message: impl Into<String>) -> RecordedError {
        RecordedError::readings(&self.name, message)
    }

    /// Error that concerns one reading. For a file, the error states the line of the reading. For arrays, `message`
    /// must state the index of the reading.
    pub(super) fn fail_at(&self, reading: usize, message: String) -> RecordedError {
        match self.line(reading) {
            Some(line) => RecordedError::line(&self.name, line, message),
            None => self.fail(message),
        }
    }

    /// Unit of lengths that the header of the file or the setting `length_unit` states. It is an error if they state
    /// different units.
    pub(super) fn unit(
        &self,
        header: Option<LengthUnit>,
        option: Option<LengthUnit>,
    ) -> Result<LengthUnit, RecordedError> {
        match (header, option) {
            (Some(header), Some(option)) if header != option => {
                let (header, option) = (header.as_str(), option.as_str());
                Err(self.fail(format!(
                    "the header says {header}, setting `length_unit` says {option}"
                )))
            }
            (header, option) => Ok(header.or(option).unwrap_or_default()),
        }
    }

    /// Text of a warning about repeated readings. A reading is repeated if all its numbers equal the numbers of an
    /// earlier reading. `None` if less than the share `share` of all readings is repeated.
    pub(super) fn repeated<const N: usize>(
        &self,
        what: &str,
        readings: impl ExactSizeIterator<Item = [f64; N]>,
        share: f64,
    ) -> Option<String> {
        let all = readings.len() as f64;
        let again = copies(readings);
        let count = again.len();
        let first = self.row(*again.first()?);
        let rows = match count {
            1 => format!("{first} repeats the {what} of an earlier row"),
            _ => format!("{count} rows, the first of them {first}, repeat {what}s of earlier rows"),
        };
        (count as f64 >= share * all)
            .then(|| format!("{rows} to the last digit: copies count once"))
    }
}

pub(super) const COPIES: &str =
    "copies are not new readings, and make the stated uncertainty too small";

pub(super) fn copies<const N: usize>(readings: impl Iterator<Item = [f64; N]>) -> Vec<usize> {
    // Adding 0 converts −0 to 0, so that −0 and 0 have the same bits.
    let bits = |numbers: [f64; N]| numbers.map(|number| (number + 0.0).to_bits());
    let mut earlier = HashSet::new();
    let is_copy = |(place, numbers)| (!earlier.insert(bits(numbers))).then_some(place);
    readings.enumerate().filter_map(is_copy).collect()
}

pub(super) fn finite<const D: usize>(
    array: &'static str,
    rows: &[[f64; D]],
) -> Result<(), RecordedError> {
    let bad = |row: &[f64; D]| row.iter().position(|number| !number.is_finite());
    let mut numbered = rows.iter().enumerate();
    let Some((row, column)) = numbered.find_map(|(row, numbers)| Some((row, bad(numbers)?))) else {
        return Ok(());
    };
    let place = if D == 1 { vec![row] } else { vec![row, column] };
    Err(not_finite(array, place, rows[row][column]))
}

pub(super) fn not_finite(array: &'static str, index: Vec<usize>, value: f64) -> RecordedError {
    RecordedError::Array {
        array,
        index,
        value: Some(value),
        message: format!("must be finite, is {}", Number(value)),
    }
}

pub(super) fn same_length(
    (array, rows): (&'static str, usize),
    (other, rows_of_other): (&str, usize),
) -> Result<(), RecordedError> {
    if rows == rows_of_other {
        return Ok(());
    }
    Err(RecordedError::Array {
        array,
        index: Vec::new(),
        value: None,
        message: format!("has {rows} rows; {other} has {rows_of_other}"),
    })
}
