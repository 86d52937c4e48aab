//! Writes CSV tables. Each value of a row comes with the name of its column.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

/// A cell of a table: the name of the column, and the text in this column.
pub type Column = (&'static str, String);

/// Writes a table. The header consists of the column names of the first row.
///
/// # Errors
/// An error if the file cannot be written.
pub fn write(path: &Path, rows: impl IntoIterator<Item = impl AsRef<[Column]>>) -> Result<()> {
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

pub(crate) fn or_empty<T>(value: Option<T>, text: impl FnOnce(T) -> String) -> String {
    value.map_or_else(String::new, text)
}
