//! Writing and reading of result tables.

use std::fmt::Display;
use std::io::Read;

use csv::{Reader, ReaderBuilder, StringRecord};

use crate::number_text::shortest;

/// A table with a header, to be written as CSV.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Column names, units appended.
    pub header: Vec<String>,
    /// Rows of as many fields.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table of these columns, without rows.
    pub fn new(header: impl IntoIterator<Item = String>) -> Self {
        Self {
            header: header.into_iter().collect(),
            rows: Vec::new(),
        }
    }

    /// A row that begins with whole numbers, followed by numbers in shortest round-trip form.
    pub fn push(&mut self, index: usize, numbers: impl IntoIterator<Item = f64>) {
        let index = std::iter::once(index.to_string());
        self.rows
            .push(index.chain(numbers.into_iter().map(shortest)).collect());
    }

    /// A row of numbers, likewise.
    pub fn push_numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        self.rows.push(numbers.into_iter().map(shortest).collect());
    }

    /// CSV text of the table (RFC 4180): what holds a comma, a quote or a line's end is quoted.
    pub fn to_csv(&self) -> String {
        csv(&self.header) + &self.rows_to_csv()
    }

    /// CSV text of the rows alone.
    pub fn rows_to_csv(&self) -> String {
        let mut text = String::new();
        self.rows.iter().for_each(|row| push_row(&mut text, row));
        text
    }
}

/// CSV text of one row, with the line's end.
pub fn csv(row: &[String]) -> String {
    let mut text = String::new();
    push_row(&mut text, row);
    text
}

/// Adds a row and the line's end to a CSV text.
pub fn push_row(text: &mut String, row: &[String]) {
    for (place, field) in row.iter().enumerate() {
        if place > 0 {
            text.push(',');
        }
        push_field(text, field);
    }
    text.push('\n');
}

/// Rows of a CSV table that palpate wrote. All lines have the same number of fields.
pub struct Rows<R> {
    reader: Reader<R>,
    record: StringRecord,
}

impl<R: Read> Rows<R> {
    /// Rows after a header line.
    pub fn new(csv: R) -> Self {
        Self::of(csv, true)
    }

    /// Rows without a header.
    pub fn without_header(csv: R) -> Self {
        Self::of(csv, false)
    }

    fn of(csv: R, has_headers: bool) -> Self {
        let mut builder = ReaderBuilder::new();
        Self {
            reader: builder.has_headers(has_headers).from_reader(csv),
            record: StringRecord::new(),
        }
    }

    /// Names of the columns.
    ///
    /// # Errors
    /// [`csv::Error`] where the text cannot be read.
    pub fn header(&mut self) -> Result<Vec<String>, csv::Error> {
        Ok(self.reader.headers()?.iter().map(str::to_owned).collect())
    }

    /// The next row and its line number, counted from 1; `None` after the last row.
    ///
    /// # Errors
    /// [`csv::Error`] if a row has more or fewer fields, or if the text cannot be read.
    pub fn next_row(&mut self) -> Result<Option<(u64, &StringRecord)>, csv::Error> {
        if !self.reader.read_record(&mut self.record)? {
            return Ok(None);
        }
        let line = self.record.position().map_or(0, csv::Position::line);
        Ok(Some((line, &self.record)))
    }
}

fn push_field(text: &mut String, field: &str) {
    let is_special = |byte: &u8| matches!(byte, b',' | b'"' | b'\n' | b'\r');
    if field.as_bytes().iter().any(is_special) {
        text.push('"');
        text.push_str(&field.replace('"', "\"\""));
        text.push('"');
    } else {
        text.push_str(field);
    }
}

/// A table of places with the curvature at each, filled field by field.
#[derive(Clone, Debug, PartialEq)]
pub struct MapTable {
    /// Rows so far.
    pub table: Table,
    /// What the map lacks if a trial fails: "cells" or "estimates of cells".
    pub lacks: &'static str,
    /// Fields of the unfinished row.
    row: Vec<String>,
}

impl MapTable {
    /// An empty table. `header` lists the column names, separated by commas.
    pub fn new(header: &str, lacks: &'static str) -> Self {
        Self {
            table: Table::new(header.split(',').map(str::to_owned)),
            lacks,
            row: Vec::new(),
        }
    }

    /// Adds a field to the row.
    pub fn text(&mut self, field: impl Display) {
        self.row.push(field.to_string());
    }

    /// Adds a number to the row, or an empty field.
    pub fn number(&mut self, value: Option<f64>) {
        self.row.push(value.map_or_else(String::new, shortest));
    }

    /// Ends the row.
    pub fn end_row(&mut self) {
        self.table.rows.push(std::mem::take(&mut self.row));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_text_reads_back_the_same() {
        let fields = [
            "plain",
            "",
            "a, b",
            "say \"x\"",
            "two\nlines",
            "cr\r",
            "\"",
            "µ",
        ];
        let mut table = Table::new(fields.map(str::to_owned));
        table.rows.push(fields.map(str::to_owned).to_vec());
        table.push(3, [-0.0, 1e-300, 0.1, 5.0, 6.0, 7.0, 8.0]);
        let csv = table.to_csv();
        let mut rows = Rows::new(csv.as_bytes());
        assert_eq!(rows.header().unwrap(), fields);
        assert_eq!(rows.next_row().unwrap().unwrap().1, fields.as_slice());
        let (_, row) = rows.next_row().unwrap().unwrap();
        assert_eq!((&row[0], &row[1], &row[3]), ("3", "0", "0.1"));
        assert_eq!(row[2].parse(), Ok(1e-300));
        assert!(rows.next_row().unwrap().is_none());
    }
}
