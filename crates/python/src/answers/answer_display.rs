//! Tables and figures of answers.

use palpate::{ReportError, Study, Table as Rows};
use pyo3::prelude::*;

use crate::error;
use crate::figure::Figure;

pub(super) fn table<'py>(
    py: Python<'py>,
    rows: &Rows,
    study: &Study,
) -> PyResult<Bound<'py, PyAny>> {
    let table = crate::table::table_of(py, rows, study.config.length_unit)?;
    Ok(table.into_bound(py))
}

pub(super) fn figure<'py>(
    py: Python<'py>,
    figure: Result<palpate::Figure, ReportError>,
) -> PyResult<Bound<'py, PyAny>> {
    let figure = figure.map_err(|error| error::RunError::new_err(error.to_string()))?;
    Ok(Bound::new(py, Figure::from(figure))?.into_any())
}
