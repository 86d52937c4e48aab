//! CSV files with their headers checked, and some named columns of them.

use crate::group::by_key;
use crate::{Files, ReportError};
use palpate_study::Rows;
use palpate_study::label::split_unit;
use palpate_study::number::finite;
use std::path::PathBuf;
use std::str::FromStr;

/// A CSV file as text, its header checked for repeated columns, and the places of the columns asked for.
pub(crate) struct Records {
    path: PathBuf,
    header: Vec<String>,
    rows: Vec<Vec<String>>,
    /// Line of each row in the file, from 1.
    lines: Vec<u64>,
    places: Vec<usize>,
}

impl Records {
    /// Columns `names` of a file, with or without a unit, in the order of `names`; there may be no rows.
    pub(crate) fn read(files: &Files, file: &str, names: &[&str]) -> Result<Self, ReportError> {
        let path = files.path(file);
        let text = files.read(file)?;
        let unreadable = |source| ReportError::Csv {
            path: path.clone(),
            source,
        };
        let text = text.trim_start_matches('\u{feff}');
        let mut table = Rows::new(text.as_bytes());
        let header = table.header().map_err(unreadable)?.into_iter();
        let header: Vec<String> = header.map(|name| name.trim().to_owned()).collect();
        if header.iter().all(String::is_empty) {
            return Err(ReportError::EmptyTable { path });
        }
        let mut columns = header.iter().enumerate();
        if let Some((_, column)) = columns.find(|(at, column)| header[..*at].contains(column)) {
            let column = column.clone();
            return Err(ReportError::DuplicateColumn { path, column });
        }
        let (mut rows, mut lines) = (Vec::new(), Vec::new());
        while let Some((line, row)) = table.next_row().map_err(unreadable)? {
            lines.push(line);
            rows.push(row.iter().map(|cell| cell.trim().to_owned()).collect());
        }
        let mut records = Self {
            path,
            header,
            rows,
            lines,
            places: Vec::new(),
        };
        for name in names {
            let is_it = |column: &String| column == name || split_unit(column).0 == *name;
            match records.header.iter().position(is_it) {
                Some(place) => records.places.push(place),
                None => return Err(records.missing(name)),
            }
        }
        Ok(records)
    }

    /// Columns as by [`Self::read`], where the first `ordered` columns stand in this order: sweep columns lie between `cell` and `quantity`,
    /// statistics after `unit`.
    pub(crate) fn read_in_order(
        files: &Files,
        file: &str,
        names: &[&str],
        ordered: usize,
    ) -> Result<Self, ReportError> {
        let records = Self::read(files, file, names)?;
        let places = records.places[..ordered].windows(2);
        match places.clone().position(|pair| pair[0] > pair[1]) {
            Some(place) => Err(records.missing(names[place + 1])),
            None => Ok(records),
        }
    }

    /// Table with at least one row, or the error that it is empty.
    pub(crate) fn filled(self) -> Result<Self, ReportError> {
        match self.rows.is_empty() {
            true => Err(ReportError::EmptyTable { path: self.path }),
            false => Ok(self),
        }
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Names of all columns.
    pub(crate) fn header(&self) -> &[String] {
        &self.header
    }

    /// Place in the header of the `column`-th of the columns asked for.
    pub(crate) fn place(&self, column: usize) -> usize {
        self.places[column]
    }

    /// Texts of the column at a place in the header.
    pub(crate) fn column(&self, place: usize) -> impl Iterator<Item = &str> {
        self.rows.iter().map(move |row| row[place].as_str())
    }

    /// Header and rows.
    pub(crate) fn into_parts(self) -> (Vec<String>, Vec<Vec<String>>) {
        (self.header, self.rows)
    }

    /// The unit of the `column`-th of the columns asked for, as in its header; may be empty.
    pub(crate) fn unit(&self, column: usize) -> &str {
        split_unit(&self.header[self.places[column]]).1
    }

    pub(crate) fn text(&self, row: usize, column: usize) -> &str {
        &self.rows[row][self.places[column]]
    }

    /// A number that a drawing can hold.
    pub(crate) fn number(&self, row: usize, column: usize) -> Result<f64, ReportError> {
        finite(self.text(row, column))
            .filter(|number| number.abs() <= LARGEST)
            .ok_or_else(|| self.bad(row, column, "a number between −1e100 and 1e100"))
    }

    /// A finite number, if there is any text.
    pub(crate) fn number_or_none(
        &self,
        row: usize,
        column: usize,
    ) -> Result<Option<f64>, ReportError> {
        match (self.text(row, column), finite(self.text(row, column))) {
            (text, None) if !text.is_empty() => Err(self.bad(row, column, "a number or nothing")),
            (_, number) => Ok(number),
        }
    }

    /// A cell that is of a type, in words `expected`.
    pub(crate) fn parsed<T: FromStr>(
        &self,
        row: usize,
        column: usize,
        expected: &'static str,
    ) -> Result<T, ReportError> {
        let parsed = self.text(row, column).parse();
        parsed.map_err(|_| self.bad(row, column, expected))
    }

    /// The rows of each text in a column.
    pub(crate) fn by_text(&self, column: usize) -> Vec<(&str, Vec<usize>)> {
        by_key((0..self.rows()).map(|row| (self.text(row, column), row)))
    }

    /// The rows of each cell, whose numbers a column holds.
    pub(crate) fn by_cell(&self, column: usize) -> Result<Vec<(u64, Vec<usize>)>, ReportError> {
        let groups = self.by_text(column).into_iter();
        let numbered = |(_, rows): (&str, Vec<usize>)| -> Result<_, ReportError> {
            Ok((self.parsed(rows[0], column, "the number of a cell")?, rows))
        };
        groups.map(numbered).collect()
    }

    /// The error that this cell is not what was `expected`.
    pub(crate) fn bad(&self, row: usize, column: usize, expected: &'static str) -> ReportError {
        self.bad_at(row, self.places[column], expected)
    }

    /// The error that a cell in the column at a place in the header is not what was `expected`.
    pub(crate) fn bad_at(&self, row: usize, place: usize, expected: &'static str) -> ReportError {
        ReportError::BadCell {
            path: self.path.clone(),
            line: self.lines[row],
            column: self.header[place].clone(),
            value: self.rows[row][place].clone(),
            expected,
        }
    }

    /// The error that the `column`-th of the columns asked for is not in `unit`.
    pub(crate) fn in_another_unit(&self, column: usize, unit: &str) -> ReportError {
        let name = split_unit(&self.header[self.places[column]]).0;
        self.missing(&[name, unit].join(if unit.is_empty() { "" } else { "_" }))
    }

    fn missing(&self, column: &str) -> ReportError {
        ReportError::MissingColumn {
            path: self.path.clone(),
            column: column.to_owned(),
            found: self.header.clone(),
        }
    }
}

/// Sums and squares of coordinates up to this are finite.
const LARGEST: f64 = 1e100;
