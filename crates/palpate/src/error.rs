//! Errors of cells and runs.

use palpate_study::config::{ConfigError, Study};
use palpate_sweep::SweepError;
use thiserror::Error;

/// Cell that cannot be run or followed.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum CellError {
    /// Number that no cell of the study has.
    #[error("there is no cell {cell}: the study has cells 0 to {last}")]
    NoCell {
        /// Number that was asked for.
        cell: usize,
        /// Largest number of a cell.
        last: usize,
    },
    /// Field of a cell's config that makes no scene.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

/// Study that cannot be run.
#[derive(Debug, Error)]
pub enum RunError {
    /// Cell that cannot be run.
    #[error(transparent)]
    Cell(#[from] CellError),
    /// Trials that cannot be run.
    #[error(transparent)]
    Sweep(#[from] SweepError<ConfigError>),
}

/// Refuses a number that no cell of the study has.
pub(crate) fn known_cell(study: &Study, cell: usize) -> Result<(), CellError> {
    let last = study.cells.len() - 1;
    match cell <= last {
        true => Ok(()),
        false => Err(CellError::NoCell { cell, last }),
    }
}
