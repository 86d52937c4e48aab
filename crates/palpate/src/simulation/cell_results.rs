//! Results of cells: statistics, table rows and warnings.

use std::sync::Arc;

use palpate_study::{Table, Warning};
use palpate_sweep::{CellStatistics, Failure};

use super::CellTruth;
use crate::run_files::Row;

/// Results of a cell after its last trial.
#[derive(Clone, Debug)]
pub struct CellResults {
    /// Number of the cell in the study.
    pub cell: usize,
    pub(super) truth: Arc<CellTruth>,
    pub(super) warnings: Vec<Warning>,
    pub(super) map: Option<Table>,
    /// Statistics of the cell. If the sign of the curvature is uncertain, there is no mean of a radius, because the
    /// radius may be infinite.
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
    /// Number of trials of the cell.
    pub trials: u64,
    /// Each kind of failure of the cell, with the number of trials that failed in this way.
    pub kinds: Vec<Failure>,
    /// Warnings of the cell that the check before the run did not report.
    pub warnings: Vec<Warning>,
}

impl CellResults {
    pub(super) fn row(&self) -> Row<'_> {
        Row {
            cell: self.cell,
            truth: &self.truth,
            statistics: &self.statistics,
        }
    }
}
