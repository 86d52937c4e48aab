//! ReadingSource of readings, for messages.

use palpate_statistics::Number;
use palpate_study::config::LengthUnit;

use super::error::RecordedError;

/// Place that readings come from.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ReadingSource {
    /// A file, and the line of each reading.
    File { name: String, lines: Vec<usize> },
    /// Arrays that a program has in memory.
    Arrays,
}

impl ReadingSource {
    /// Name of the readings in messages.
    pub(super) fn name(&self) -> &str {
        match self {
            Self::File { name, .. } => name,
            Self::Arrays => "readings",
        }
    }

    /// Line of a reading, if it has one.
    pub(super) fn line(&self, reading: usize) -> Option<usize> {
        match self {
            Self::File { lines, .. } => lines.get(reading).copied(),
            Self::Arrays => None,
        }
    }

    /// Error that concerns the readings as a whole.
    pub(super) fn fail(&self, message: String) -> RecordedError {
        RecordedError::Readings {
            file: self.name().to_owned(),
            message,
        }
    }

    /// Error that concerns one reading, with its line in a file. For arrays, the message must state its index.
    pub(super) fn fail_at(&self, reading: usize, message: String) -> RecordedError {
        match (self, self.line(reading)) {
            (Self::File { name, .. }, Some(line)) => RecordedError::Line {
                file: name.clone(),
                line,
                message,
            },
            _ => self.fail(message),
        }
    }
}

/// The unit that the header of a file or the setting `length_unit` states.
pub(super) fn agreed_unit(
    origin: &ReadingSource,
    header: Option<LengthUnit>,
    option: Option<LengthUnit>,
) -> Result<LengthUnit, RecordedError> {
    match (header, option) {
        (Some(header), Some(option)) if header != option => {
            let (header, option) = (header.as_str(), option.as_str());
            Err(origin.fail(format!(
                "the header says {header}, setting `length_unit` says {option}"
            )))
        }
        (header, option) => Ok(header.or(option).unwrap_or_default()),
    }
}

/// Refuses numbers of an array that are not finite.
pub(super) fn finite<const D: usize>(
    array: &'static str,
    rows: &[[f64; D]],
) -> Result<(), RecordedError> {
    let is_good = |row: &[f64; D]| row.iter().all(|number| number.is_finite());
    let Some(row) = rows.iter().position(|row| !is_good(row)) else {
        return Ok(());
    };
    let column = rows[row].iter().position(|number| !number.is_finite());
    let column = column.unwrap_or_default();
    let value = rows[row][column];
    Err(RecordedError::Array {
        array,
        index: if D == 1 { vec![row] } else { vec![row, column] },
        value: Some(value),
        message: format!("must be finite, is {}", Number(value)),
    })
}

/// Rejects an array that has more or fewer rows than another.
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
