//! Cells that have been run, and the rows that they become.

use std::sync::Arc;

use palpate_sweep::{CellStatistics, Failure, Partial};

use crate::facts::Facts;
use crate::map::CellMap;
use crate::means;
use crate::share::Part;

/// Trials that a task has run: of a cell, or of a superblock of one.
#[derive(Clone, Debug)]
pub struct Finished {
    pub(super) part: Part,
    pub(super) facts: Arc<Facts>,
    pub(super) warnings: Vec<String>,
    pub(super) map: Option<CellMap>,
    pub(super) partial: Partial,
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
        self.part.cell
    }

    /// Number of the superblock that was run, and how many the cell has.
    pub fn superblock(&self) -> (u64, u64) {
        (self.part.superblock, self.part.of)
    }

    /// Sums of the trials.
    pub fn partial(&self) -> &Partial {
        &self.partial
    }

    /// Adds the superblock that follows.
    pub fn merge(&mut self, next: Self) {
        self.partial.merge(next.partial);
    }

    /// The cell with the sums of all its superblocks.
    #[must_use]
    pub fn with(self, partial: Partial) -> Self {
        Self { partial, ..self }
    }

    /// Statistics, without means of numbers that have none.
    pub(super) fn statistics(&self) -> CellStatistics {
        let mut statistics = self.partial.statistics();
        means::withhold(self.facts.quantities, &mut statistics.quantities);
        statistics
    }
}
