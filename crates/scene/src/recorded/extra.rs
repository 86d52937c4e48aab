//! Columns of a table that palpate does not ask for, kept as they are.

use std::collections::BTreeMap;

/// Fields of the columns that palpate does not ask for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Extras {
    /// Names of the columns, as the file has them.
    pub(super) names: Vec<String>,
    /// Rows as CSV, one after the other.
    text: String,
    /// Where each row ends in the text.
    ends: Vec<usize>,
}

impl Extras {
    pub(super) fn new(names: Vec<String>) -> Self {
        let (text, ends) = Default::default();
        Self { names, text, ends }
    }

    /// Adds a row, which a function writes as CSV.
    pub(super) fn push(&mut self, write: impl FnOnce(&mut String)) {
        if !self.names.is_empty() {
            write(&mut self.text);
            self.ends.push(self.text.len());
        }
    }

    /// Bytes of all rows.
    pub(super) const fn bytes(&self) -> usize {
        self.text.len()
    }

    /// Fields of a row; none where there are no such columns.
    pub(super) fn row(&self, row: usize) -> Vec<String> {
        let Some(&end) = self.ends.get(row) else {
            return Vec::new();
        };
        let before = row.checked_sub(1).and_then(|before| self.ends.get(before));
        let text = &self.text[before.copied().unwrap_or(0)..end];
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(text.as_bytes());
        let record = reader.records().next().and_then(Result::ok);
        let fields = record.unwrap_or_default();
        // A row of one empty field is a blank line.
        let fields = fields
            .iter()
            .map(str::to_owned)
            .chain(std::iter::repeat(String::new()));
        fields.take(self.names.len()).collect()
    }

    /// Fields of a row by the names of their columns.
    pub(super) fn named(&self, row: usize) -> BTreeMap<String, String> {
        self.names.iter().cloned().zip(self.row(row)).collect()
    }
}
