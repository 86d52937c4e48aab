//! Columns of a table that palpate does not use and keeps unchanged.

use std::collections::BTreeMap;

/// Fields of the columns that palpate does not use.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct ExtraColumns {
    /// Names of the columns, as the file has them.
    pub(super) names: Vec<String>,
    /// Text of all fields, row by row, without separators.
    text: String,
    /// Byte position in `text` at which each field ends.
    ends: Vec<usize>,
}

impl ExtraColumns {
    pub(super) fn new(names: Vec<String>) -> Self {
        let (text, ends) = Default::default();
        Self { names, text, ends }
    }

    /// Adds the fields of a row.
    pub(super) fn push<'a>(&mut self, fields: impl Iterator<Item = &'a str>) {
        for field in fields {
            self.text.push_str(field);
            self.ends.push(self.text.len());
        }
    }

    /// Size of all rows in bytes, with one delimiter per field.
    pub(super) const fn bytes(&self) -> usize {
        self.text.len() + self.ends.len()
    }

    /// Fields of a row; empty if there are no such columns.
    pub(super) fn row(&self, row: usize) -> Vec<String> {
        let first = row * self.names.len();
        let ends = self.ends.iter().skip(first).take(self.names.len());
        let before = first
            .checked_sub(1)
            .and_then(|before| self.ends.get(before));
        let mut start = before.copied().unwrap_or_default();
        let field = |end: &usize| self.text[std::mem::replace(&mut start, *end)..*end].to_owned();
        ends.map(field).collect()
    }

    /// Fields of a row by the names of their columns.
    pub(super) fn named(&self, row: usize) -> BTreeMap<String, String> {
        self.names.iter().cloned().zip(self.row(row)).collect()
    }
}
