//! Converts the tables and figures of answers to Python objects.

use palpate::{ReportError, Study, Table as Rows};
use pyo3::prelude::*;

use crate::error;
use crate::figure::Figure;

pub(super) fn table<'py>(
    py: Python<'py>,
    rows: &Rows,
    study: &Study,
) -> PyResult<Bound<'py, PyAny>> {
    crate::table::table_of(py, rows, study.config.length_unit)
}

pub(super) fn figure<'py>(
    py: Python<'py>,
    figure: Result<palpate::Figure, ReportError>,
) -> PyResult<Bound<'py, PyAny>> {
    let figure = figure.map_err(error::run)?;
    Ok(Bound::new(py, Figure::from(figure))?.into_any())
}
