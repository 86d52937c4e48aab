//! A table of places with the curvature at each.

use std::fmt::Display;

use crate::{Table, number};

/// Table of maps, filled field by field.
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
    /// Empty table; `header` lists the column names, separated by commas.
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
        self.row.push(value.map_or_else(String::new, number));
    }

    /// Ends the row.
    pub fn end_row(&mut self) {
        self.table.rows.push(std::mem::take(&mut self.row));
    }
}
