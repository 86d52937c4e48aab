//! CSV tables from rows that name their columns.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use serde::Serialize;

/// Name of a column, and the value of one row in this column.
pub(crate) type Column = (&'static str, String);

/// Writes a table. The header has the column names of the first row.
pub(crate) fn write(
    path: &Path,
    rows: impl IntoIterator<Item = impl AsRef<[Column]>>,
) -> Result<()> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (at, row) in rows.into_iter().enumerate() {
        let row = row.as_ref();
        if at == 0 {
            writer.write_record(row.iter().map(|(name, _)| name))?;
        }
        writer.write_record(row.iter().map(|(_, field)| field))?;
    }
    let bytes = writer.into_inner().context("the table is incomplete")?;
    fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

/// Text of a value; empty for `None`.
pub(crate) fn or_empty<T>(value: Option<T>, text: impl FnOnce(T) -> String) -> String {
    value.map_or_else(String::new, text)
}

/// Text of a table whose columns are the fields of its rows. A NaN becomes an empty field.
///
/// # Errors
/// If a row cannot be serialized.
pub fn text<S: Serialize>(rows: &[S]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    // No name starts with `NaN`.
    Ok(String::from_utf8(writer.into_inner()?)?.replace(",NaN", ","))
}

/// One row for a terminal: names and values of the columns that are not empty, numbers with four digits.
///
/// # Errors
/// As [`text`].
pub fn row_in_words(row: &impl Serialize) -> Result<String> {
    let text = text(&[row])?;
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let names = reader.headers()?.clone();
    let row = reader
        .records()
        .next()
        .context("the row has no columns")??;
    let word = |(name, value): (&str, &str)| match value.parse::<f64>() {
        Ok(number) => {
            let rounded = format!("{number:.3e}").parse().unwrap_or(number);
            format!("{name} {rounded}")
        }
        Err(_) => format!("{name} {value}"),
    };
    let columns = names
        .iter()
        .zip(&row)
        .filter(|(_, value)| !value.is_empty());
    Ok(columns.map(word).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Row {
        scene: &'static str,
        width: f64,
        lowest: f64,
    }

    #[test]
    fn rows_are_tables_and_words() {
        let row = Row {
            scene: "a, b",
            width: 0.123_456,
            lowest: f64::NAN,
        };
        assert_eq!(row_in_words(&row).unwrap(), "scene a, b, width 0.1235");
        let text = text(&[row]).unwrap();
        assert_eq!(text, "scene,width,lowest\n\"a, b\",0.123456,\n");
    }
}
