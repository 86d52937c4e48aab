//! CSV files with named columns, and groups of rows.

use crate::{Files, ReportError};
use palpate_study::Rows;
use palpate_study::label::split_unit;
use palpate_study::number::finite;
use std::path::PathBuf;
use std::str::FromStr;

/// Contents of a CSV file, as texts. All columns have different names. Some columns were requested when the file was
/// read; `places` are the indices of these columns in the header.
pub(crate) struct Records {
    path: PathBuf,
    header: Vec<String>,
    rows: Vec<Vec<String>>,
    /// Line number in the file of each row of the table, counted from 1.
    lines: Vec<u64>,
    places: Vec<usize>,
}

impl Records {
    /// Reads a CSV file that must contain the columns `names`. In the header of the file, a unit may follow each name.
    /// The file may have no rows.
    pub(crate) fn read(files: &Files, file: &str, names: &[&str]) -> Result<Self, ReportError> {
        let path = files.path(file);
        let text = files.read(file)?;
        let unreadable = |source| ReportError::Csv {
            path: path.clone(),
            source,
        };
        let bad = |problem: String| ReportError::BadTable {
            path: path.clone(),
            problem,
        };
        let text = text.trim_start_matches('\u{feff}');
        let mut table = Rows::new(text.as_bytes(), true);
        let header = table.header().map_err(unreadable)?.into_iter();
        let header: Vec<String> = header.map(|name| name.trim().to_owned()).collect();
        if header.iter().all(String::is_empty) {
            return Err(bad(EMPTY.to_owned()));
        }
        let mut columns = header.iter().enumerate();
        if let Some((_, column)) = columns.find(|(at, column)| header[..*at].contains(column)) {
            return Err(bad(format!("column {column:?} appears twice")));
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
            let place = records.find(name);
            let missing = || records.missing(name);
            let place = place.ok_or_else(missing)?;
            records.places.push(place);
        }
        Ok(records)
    }

    /// Index in the header of the column with this name, with or without a unit; `None` if there is no such column.
    pub(crate) fn find(&self, name: &str) -> Option<usize> {
        let is_it = |column: &String| column == name || split_unit(column).0 == name;
        self.header.iter().position(is_it)
    }

    /// Reads a file like [`Self::read`]. The first `ordered` names must have the same order in the file. The order
    /// matters, because the columns of `cells.csv` between `cell` and `quantity` are read as swept fields, and the
    /// columns after `unit` as statistics.
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

    pub(crate) fn filled(self) -> Result<Self, ReportError> {
        match self.rows.is_empty() {
            true => Err(self.error(EMPTY.to_owned())),
            false => Ok(self),
        }
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows.len()
    }

    pub(crate) fn header(&self) -> &[String] {
        &self.header
    }

    /// Index, in the header of the file, of a column that was requested when the file was read. `column` is its index
    /// among the requested columns.
    pub(crate) fn place(&self, column: usize) -> usize {
        self.places[column]
    }

    pub(crate) fn column(&self, place: usize) -> impl Iterator<Item = &str> {
        self.rows.iter().map(move |row| row[place].as_str())
    }

    pub(crate) fn into_parts(self) -> (Vec<String>, Vec<Vec<String>>) {
        (self.header, self.rows)
    }

    pub(crate) fn unit(&self, column: usize) -> &str {
        split_unit(&self.header[self.places[column]]).1
    }

    pub(crate) fn text(&self, row: usize, column: usize) -> &str {
        &self.rows[row][self.places[column]]
    }

    /// The finite number in a cell of the table. Returns an error if the cell has no number, or a number that is too
    /// large to be drawn.
    pub(crate) fn number(&self, row: usize, column: usize) -> Result<f64, ReportError> {
        finite(self.text(row, column))
            .filter(|number| number.abs() <= LARGEST)
            .ok_or_else(|| self.bad(row, column, "a number between −1e100 and 1e100"))
    }

    /// Finite number in a cell of the table; `None` if the cell is empty.
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

    /// Value in a cell of the table, parsed as the type `T`. Error messages use `expected` as the name of this type.
    pub(crate) fn parsed<T: FromStr>(
        &self,
        row: usize,
        column: usize,
        expected: &'static str,
    ) -> Result<T, ReportError> {
        let parsed = self.text(row, column).parse();
        parsed.map_err(|_| self.bad(row, column, expected))
    }

    /// Indices of the table's rows, grouped by the text in a column.
    pub(crate) fn by_text(&self, column: usize) -> Vec<(&str, Vec<usize>)> {
        by_key((0..self.rows()).map(|row| (self.text(row, column), row)))
    }

    /// Indices of the table's rows, grouped by the number of the study's cell (grid point) in a column.
    pub(crate) fn by_cell(&self, column: usize) -> Result<Vec<(u64, Vec<usize>)>, ReportError> {
        let groups = self.by_text(column).into_iter();
        let numbered = |(_, rows): (&str, Vec<usize>)| -> Result<_, ReportError> {
            Ok((self.parsed(rows[0], column, "the number of a cell")?, rows))
        };
        groups.map(numbered).collect()
    }

    pub(crate) fn bad(&self, row: usize, column: usize, expected: &'static str) -> ReportError {
        self.bad_at(row, self.places[column], expected)
    }

    /// Error for a cell of the table that does not contain what `expected` describes. `place` is the index of the
    /// column in the header.
    pub(crate) fn bad_at(&self, row: usize, place: usize, expected: &'static str) -> ReportError {
        let (line, column, value) = (self.lines[row], &self.header[place], &self.rows[row][place]);
        self.error(format!(
            "line {line}, column {column:?}: {value:?} is not {expected}"
        ))
    }

    /// Error for a requested column whose unit is not `unit`.
    pub(crate) fn in_another_unit(&self, column: usize, unit: &str) -> ReportError {
        let name = split_unit(&self.header[self.places[column]]).0;
        self.missing(&[name, unit].join(if unit.is_empty() { "" } else { "_" }))
    }

    fn missing(&self, column: &str) -> ReportError {
        let header = self.header.join(", ");
        self.error(format!("no column {column:?}; the header has: {header}"))
    }

    fn error(&self, problem: String) -> ReportError {
        let path = self.path.clone();
        ReportError::BadTable { path, problem }
    }
}

const EMPTY: &str = "the table is empty";

/// Largest accepted absolute value of a number in a table. The squares of such numbers do not overflow.
const LARGEST: f64 = 1e100;

/// Groups items by their keys. Groups are in the order in which their keys first appear.
pub(crate) fn by_key<K: PartialEq, T>(items: impl IntoIterator<Item = (K, T)>) -> Vec<(K, Vec<T>)> {
    let mut groups: Vec<(K, Vec<T>)> = Vec::new();
    for (key, item) in items {
        // Search from the last group, because items with the same key are mostly neighbours.
        match groups.iter_mut().rev().find(|(known, _)| *known == key) {
            Some((_, items)) => items.push(item),
            None => groups.push((key, vec![item])),
        }
    }
    groups
}

/// Removes repeated items. The remaining items stay in the order in which they first appear.
pub(crate) fn distinct<T: PartialEq>(items: impl IntoIterator<Item = T>) -> Vec<T> {
    let keys = items.into_iter().map(|item| (item, ()));
    by_key(keys).into_iter().map(|(item, _)| item).collect()
}
