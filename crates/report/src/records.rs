//! CSV files with their headers checked: whole, or some named columns of a long one.

use crate::table::finite;
use crate::{ReportError, file, words};
use std::path::{Path, PathBuf};

/// A CSV file as text, its header checked for required and repeated columns.
pub(crate) struct Records {
    pub(crate) header: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
    pub(crate) lines: Vec<u64>,
}

impl Records {
    pub(crate) fn read(path: &Path, required: &[&str]) -> Result<Self, ReportError> {
        let text = file::read(path)?;
        let (header, mut reader) = open(path, &text)?;
        // The required columns must also stand in this order: sweep columns lie between `cell` and `quantity`,
        // statistics after `unit`.
        let mut next = 0;
        for name in required {
            match header[next..].iter().position(|column| column == name) {
                Some(at) => next += at + 1,
                None => return Err(missing(path, name, header)),
            }
        }
        let (mut rows, mut lines) = (Vec::new(), Vec::new());
        for record in reader.records() {
            let record = record.map_err(|source| unreadable(path, source))?;
            lines.push(record.position().map_or(0, csv::Position::line));
            rows.push(record.iter().map(|cell| cell.trim().to_owned()).collect());
        }
        Ok(Self {
            header,
            rows,
            lines,
        })
    }
}

/// Some columns of a CSV file, found by their names with or without a unit.
pub(crate) struct Columns {
    path: PathBuf,
    headers: Vec<String>,
    rows: Vec<Vec<String>>,
    lines: Vec<u64>,
}

impl Columns {
    /// The columns `names` of the file at `path`, in the order of `names`; it has at least one row.
    pub(crate) fn read(path: &Path, names: &[&str]) -> Result<Self, ReportError> {
        let columns = Self::read_any(path, names)?;
        if columns.rows.is_empty() {
            return Err(ReportError::EmptyTable {
                path: path.to_owned(),
            });
        }
        Ok(columns)
    }

    /// Columns `names` of the file at `path`, in the order of `names`; there may be no rows.
    pub(crate) fn read_any(path: &Path, names: &[&str]) -> Result<Self, ReportError> {
        let text = file::read(path)?;
        let (header, mut reader) = open(path, &text)?;
        let place = |name: &&str| {
            header
                .iter()
                .position(|column| column == name || words::split_unit(column).0 == *name)
                .ok_or_else(|| missing(path, name, header.clone()))
        };
        let places = names.iter().map(place).collect::<Result<Vec<_>, _>>()?;
        let (mut rows, mut lines) = (Vec::new(), Vec::new());
        for record in reader.records() {
            let record = record.map_err(|source| unreadable(path, source))?;
            lines.push(record.position().map_or(0, csv::Position::line));
            let cells = places.iter().map(|at| record.get(*at).unwrap_or_default());
            rows.push(cells.map(|cell| cell.trim().to_owned()).collect());
        }
        Ok(Self {
            path: path.to_owned(),
            headers: places.into_iter().map(|at| header[at].clone()).collect(),
            rows,
            lines,
        })
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The error that the `column`-th of the columns asked for is not in `unit`.
    pub(crate) fn in_another_unit(&self, column: usize, unit: &str) -> ReportError {
        let name = words::split_unit(&self.headers[column]).0;
        let wanted = [name, unit].join(if unit.is_empty() { "" } else { "_" });
        missing(&self.path, &wanted, self.headers.clone())
    }

    /// The unit of the `column`-th of the columns asked for, as in its header; may be empty.
    pub(crate) fn unit(&self, column: usize) -> &str {
        words::split_unit(&self.headers[column]).1
    }

    pub(crate) fn text(&self, row: usize, column: usize) -> &str {
        &self.rows[row][column]
    }

    /// A number that a drawing can hold.
    pub(crate) fn number(&self, row: usize, column: usize) -> Result<f64, ReportError> {
        finite(self.text(row, column))
            .filter(|number| number.abs() <= LARGEST)
            .ok_or_else(|| self.bad(row, column, "a number between −1e100 and 1e100"))
    }

    /// The error that this cell is not what was `expected`.
    pub(crate) fn bad(&self, row: usize, column: usize, expected: &'static str) -> ReportError {
        ReportError::BadCell {
            path: self.path.clone(),
            line: self.lines[row],
            column: self.headers[column].clone(),
            value: self.text(row, column).to_owned(),
            expected,
        }
    }
}

/// Sums and squares of coordinates up to this are finite.
const LARGEST: f64 = 1e100;

/// The header, without repeated columns, and a reader of the rows.
fn open<'a>(
    path: &Path,
    text: &'a str,
) -> Result<(Vec<String>, csv::Reader<&'a [u8]>), ReportError> {
    let mut reader = csv::Reader::from_reader(text.trim_start_matches('\u{feff}').as_bytes());
    let header: Vec<String> = reader
        .headers()
        .map_err(|source| unreadable(path, source))?
        .iter()
        .map(|h| h.trim().to_owned())
        .collect();
    if header.iter().all(String::is_empty) {
        return Err(ReportError::EmptyTable {
            path: path.to_owned(),
        });
    }
    for (at, column) in header.iter().enumerate() {
        if header[..at].contains(column) {
            return Err(ReportError::DuplicateColumn {
                path: path.to_owned(),
                column: column.clone(),
            });
        }
    }
    Ok((header, reader))
}

fn unreadable(path: &Path, source: csv::Error) -> ReportError {
    ReportError::Csv {
        path: path.to_owned(),
        source,
    }
}

fn missing(path: &Path, column: &str, found: Vec<String>) -> ReportError {
    ReportError::MissingColumn {
        path: path.to_owned(),
        column: column.to_owned(),
        found,
    }
}
