//! Results of cells, their table rows and their warnings.

use std::collections::BTreeMap;
use std::sync::Arc;

use palpate_sweep::{CellStatistics, Failure};

use super::CellTruth;
use crate::run_files::{CellMap, Row};

/// Results of a cell after its last trial.
#[derive(Clone, Debug)]
pub struct CellResults {
    pub(super) cell: usize,
    pub(super) truth: Arc<CellTruth>,
    pub(super) warnings: Vec<String>,
    pub(super) map: Option<CellMap>,
    /// Statistics. The mean of an inverse, such as a radius, is left out if the sign is uncertain.
    pub(super) statistics: CellStatistics,
}

/// Table rows of a cell, as CSV text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellRows {
    /// Rows of `cells.csv`.
    pub cells: String,
    /// Rows of `failures.csv`.
    pub failures: String,
    /// Rows of `map.csv`.
    pub map: String,
    /// Kind of the failure of the trial that the map would show.
    pub map_failed: Option<&'static str>,
    /// Number of trials.
    pub trials: u64,
    /// Numbers of failed trials by kind.
    pub kinds: Vec<Failure>,
    /// Warnings of the cell that were not reported before the run.
    pub warnings: Vec<String>,
}

impl CellResults {
    /// Number of the cell.
    pub fn cell(&self) -> usize {
        self.cell
    }

    pub(super) fn row(&self) -> Row<'_> {
        Row {
            cell: self.cell,
            truth: &self.truth,
            statistics: &self.statistics,
        }
    }
}

/// Warnings of cells, each text once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Warnings {
    /// For each line: the first cell with it, its place among the lines of that cell, and the number of cells.
    lines: BTreeMap<String, (usize, usize, usize)>,
}

impl Warnings {
    /// Lines, each with the first cell, its place among the lines of that cell, and the number of cells.
    pub fn entries(&self) -> impl Iterator<Item = (&str, (usize, usize, usize))> {
        let lines = self.lines.iter();
        lines.map(|(line, entry)| (line.as_str(), *entry))
    }

    /// Adds a line that `count` cells have.
    pub fn insert(&mut self, line: String, (cell, place, count): (usize, usize, usize)) {
        let entry = self.lines.entry(line).or_insert((cell, place, 0));
        *entry = match (entry.0, entry.1) <= (cell, place) {
            true => (entry.0, entry.1, entry.2 + count),
            false => (cell, place, entry.2 + count),
        };
    }

    /// Adds the lines of a cell.
    pub fn add(&mut self, cell: usize, lines: Vec<String>) {
        for (place, line) in lines.into_iter().enumerate() {
            self.insert(line, (cell, place, 1));
        }
    }

    /// Lines with words for their cells, in the order of the first cells. `cells` is the number of all cells.
    pub fn lines(&self, cells: usize) -> Vec<String> {
        let mut entries: Vec<_> = self.entries().collect();
        entries.sort_by_key(|&(_, (cell, place, _))| (cell, place));
        let words = |(line, (first, _, count)): (&str, (usize, usize, usize))| match (count, cells)
        {
            (_, 1) => line.to_owned(),
            (1, _) => format!("{line} (cell {first})"),
            (_, all) => format!("{line} ({count} of {all} cells, the first is {first})"),
        };
        entries.into_iter().map(words).collect()
    }
}
