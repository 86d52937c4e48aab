//! Tables of maps.

use std::fmt::{Display, Write};

/// Map as CSV text, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct MapTable {
    csv: String,
    /// Name of what is missing where a trial fails: "cells" or "estimates of cells".
    pub lacks: &'static str,
}

impl MapTable {
    pub(crate) fn new(header: impl Display, lacks: &'static str) -> Self {
        let csv = format!("{header}\n");
        Self { csv, lacks }
    }

    /// The table as CSV text.
    pub fn into_csv(self) -> String {
        self.csv
    }

    /// Adds a field to the row; one without commas.
    pub(crate) fn text(&mut self, field: impl Display) {
        let _ = write!(self.csv, "{field},");
    }

    /// Adds a number to the row, or an empty field.
    pub(crate) fn number(&mut self, value: Option<f64>) {
        match value {
            // Zero without a sign.
            Some(value) => self.text(value + 0.0),
            None => self.text(""),
        }
    }

    /// Ends the row.
    pub(crate) fn end_row(&mut self) {
        self.csv.pop();
        self.csv.push('\n');
    }
}
