//! Reads the options of an estimate from the study in the argument `like`.

use palpate::config::{LengthUnit, StudyConfig};
use palpate::recorded::StudyMismatch;
use pyo3::prelude::*;

use crate::error;
use crate::study::Study;

/// Options of an estimate, taken from a cell of a study. Lengths are converted to the unit of the readings. If this
/// unit is not stated (`None`), lengths keep the unit of the study.
pub(crate) fn like<T>(
    study: Option<&Bound<'_, Study>>,
    cell: usize,
    unit: Option<LengthUnit>,
    options: fn(&StudyConfig, LengthUnit) -> Result<T, StudyMismatch>,
) -> PyResult<Option<T>> {
    let Some(study) = study.map(|study| study.get().study()) else {
        return Ok(None);
    };
    let of_cell = study.cell(cell).map_err(error::config)?;
    let unit = unit.unwrap_or(of_cell.config.length_unit);
    let options = options(&of_cell.config, unit);
    options
        .map(Some)
        .map_err(|error| error::config(study.error_at(cell, error.path(), error.to_string())))
}
