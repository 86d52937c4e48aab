//! Writes and reads tables of results.

use std::io::Read;

use csv::{Reader, ReaderBuilder, StringRecord};

use crate::config::LengthUnit;
use crate::number_text::shortest;
use crate::quantity::Unit;

/// Column of a table: its name, and the unit and type of its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name in the table's header. If all numbers of the column have the same unit, the name ends with this unit.
    pub name: String,
    /// Unit of all numbers in the column, or `1` for pure numbers. If each row states its own unit, this is
    /// [`Column::UNIT_OF_ROW`]. `None` for texts, and for the parameters of a formula, whose units depend on the
    /// formula.
    pub unit: Option<String>,
    /// Type of the values in the column.
    pub values: ColumnType,
}

/// Type of the values of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnType {
    /// Numbers.
    Number,
    /// Whole numbers.
    Whole,
    /// Whole numbers that are not negative: counts, and numbers that identify cells or trials.
    Count,
    /// Texts.
    Text,
}

impl Column {
    /// Value of [`Column::unit`] for a column in which each row has its own unit. The column `unit` states this unit.
    pub const UNIT_OF_ROW: &'static str = "column unit";

    fn new(name: &str, unit: Option<&str>, values: ColumnType) -> Self {
        Self {
            name: name.to_owned(),
            unit: unit.map(str::to_owned),
            values,
        }
    }

    /// A column of numbers that are not lengths. The unit of pure numbers is `1`.
    pub fn number(name: &str, unit: &str) -> Self {
        Self::new(name, Some(unit), ColumnType::Number)
    }

    /// Columns of numbers without a unit.
    pub fn pure<const N: usize>(names: [&str; N]) -> [Self; N] {
        names.map(|name| Self::number(name, "1"))
    }

    /// Columns of lengths or curvatures. The unit is appended to each name: `x_mm`, `mean_curvature_per_mm`.
    pub fn in_length<const N: usize>(
        names: [&str; N],
        unit: Unit,
        length: LengthUnit,
    ) -> [Self; N] {
        let unit = unit.of(length);
        let ending = unit.replace("1/", "per_").replace('^', "");
        names.map(|name| Self::number(&format!("{name}_{ending}"), unit))
    }

    /// A column of counts, or of numbers that identify cells, trials or other things.
    pub fn count(name: &str) -> Self {
        Self::new(name, Some("1"), ColumnType::Count)
    }

    /// Column of texts.
    pub fn text(name: &str) -> Self {
        Self::new(name, None, ColumnType::Text)
    }
}

impl From<String> for Column {
    fn from(name: String) -> Self {
        Self::new(&name, None, ColumnType::Number)
    }
}

/// A table that can be written as CSV.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The columns of the table, from left to right.
    pub columns: Vec<Column>,
    /// Rows, with the text of each value.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these columns and no rows.
    pub fn new(columns: impl IntoIterator<Item: Into<Column>>) -> Self {
        Self {
            columns: columns.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row that begins with the whole number `index`. Each of the other numbers is written as the shortest text
    /// that parses to the same number.
    pub fn push(&mut self, index: usize, numbers: impl IntoIterator<Item = f64>) {
        let index = std::iter::once(index.to_string());
        self.rows
            .push(index.chain(numbers.into_iter().map(shortest)).collect());
    }

    /// Adds a row of numbers. Each number is written as the shortest text that parses to the same number.
    pub fn push_numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        self.rows.push(numbers.into_iter().map(shortest).collect());
    }

    /// The table as CSV text (RFC 4180): a value that contains a comma, a quotation mark or a line break is quoted.
    pub fn to_csv(&self) -> String {
        let names: Vec<String> = self
            .columns
            .iter()
            .map(|column| column.name.clone())
            .collect();
        let mut text = String::new();
        push_row(&mut text, &names);
        text + &self.rows_to_csv()
    }

    /// The rows as CSV text, without the header.
    pub fn rows_to_csv(&self) -> String {
        let mut text = String::new();
        self.rows.iter().for_each(|row| push_row(&mut text, row));
        text
    }
}

/// Adds a row to a CSV text, with a line break at its end.
pub fn push_row(text: &mut String, row: &[String]) {
    for (place, field) in row.iter().enumerate() {
        if place > 0 {
            text.push(',');
        }
        push_field(text, field);
    }
    text.push('\n');
}

/// Reads the rows of a CSV table that palpate wrote. All lines of such a table have the same number of values.
pub struct Rows<R> {
    reader: Reader<R>,
    record: StringRecord,
}

impl<R: Read> Rows<R> {
    /// Reader of the rows of the CSV table `csv`. `has_header` states whether the first line is a header.
    pub fn new(csv: R, has_header: bool) -> Self {
        let mut builder = ReaderBuilder::new();
        Self {
            reader: builder.has_headers(has_header).from_reader(csv),
            record: StringRecord::new(),
        }
    }

    /// Names of the columns, from the header line.
    ///
    /// # Errors
    /// [`csv::Error`] if the text cannot be read.
    pub fn header(&mut self) -> Result<Vec<String>, csv::Error> {
        Ok(self.reader.headers()?.iter().map(str::to_owned).collect())
    }

    /// The next row and its line number, counted from 1; `None` after the last row.
    ///
    /// # Errors
    /// [`csv::Error`] if a row has more or fewer values than the other lines, or if the text cannot be read.
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
