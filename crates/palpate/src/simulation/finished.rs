//! Cells that have been run, and the rows that they become.

use std::sync::Arc;

use palpate_sweep::{CellStatistics, Failure};

use crate::facts::Facts;
use crate::map::CellMap;
use crate::tables::Row;

/// Cell whose trials have all been run.
#[derive(Clone, Debug)]
pub struct Finished {
    pub(super) cell: usize,
    pub(super) facts: Arc<Facts>,
    pub(super) warnings: Vec<String>,
    pub(super) map: Option<CellMap>,
    /// Statistics. The mean of an inverse, such as a radius, is left out if the sign is uncertain.
    pub(super) statistics: CellStatistics,
}

/// Rows of the tables of a cell, as CSV text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellRows {
    /// Rows of `cells.csv`.
    pub cells: String,
    /// Rows of `failures.csv`.
    pub failures: String,
    /// Rows of `map.csv`.
    pub map: String,
    /// Stable name of how the trial failed that the map would be of.
    pub map_failed: Option<&'static str>,
    /// Number of trials, and of those that failed by kind.
    pub trials: u64,
    /// Failures, one entry per kind.
    pub kinds: Vec<Failure>,
    /// Lines that warn of the cell, where they were not told before.
    pub warnings: Vec<String>,
}

impl Finished {
    /// Number of the cell.
    pub fn cell(&self) -> usize {
        self.cell
    }

    pub(super) fn row(&self) -> Row<'_> {
        Row {
            cell: self.cell,
            facts: &self.facts,
            statistics: &self.statistics,
        }
    }
}
