//! Converts tables of results to Python tables, column by column.

use numpy::PyArray1;
use palpate::config::LengthUnit;
use palpate::{Column, Table, Values, columns, unit_of};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error;

/// Converts CSV text to a `palpate.Table`. Its lengths are in `unit`.
pub(crate) fn table<'py>(
    py: Python<'py>,
    csv: &str,
    known: &[Column],
    unit: LengthUnit,
) -> PyResult<Bound<'py, PyAny>> {
    let columns = columns(csv, known)
        .map_err(|error| error::RunError::new_err(format!("no table: {error}")))?;
    let (arrays, units) = (PyDict::new(py), PyDict::new(py));
    for (column, values) in columns {
        let name = stem(&column.name, unit);
        match values {
            Values::Numbers(numbers) => {
                arrays.set_item(name, PyArray1::from_vec(py, numbers))?;
            }
            Values::Texts(ref texts) => {
                let texts = py.import("numpy")?.call_method1("array", (texts, "str"))?;
                arrays.set_item(name, texts)?;
            }
        }
        let is_unit = |unit: &String| unit != "1" && unit != Column::UNIT_OF_ROW;
        let stated = column.unit.filter(is_unit);
        units.set_item(name, stated.or_else(|| unit_of(&column.name, unit)))?;
    }
    let class = py.import("palpate._table")?.getattr("Table")?;
    class.call1((arrays, units, csv))
}

/// Name of a column without its length unit: `x` for `x_mm`. Other units stay in the name, as in `rotation_x_rad`.
fn stem(name: &str, length_unit: LengthUnit) -> &str {
    let length = length_unit.as_str();
    let endings = [
        format!("_per_{length}2"),
        format!("_per_{length}"),
        format!("_{length}"),
    ];
    (endings.iter().find_map(|end| name.strip_suffix(end))).unwrap_or(name)
}

/// Converts the rows of a table to a `palpate.Table`. Its lengths are in `unit`.
pub(crate) fn table_of<'py>(
    py: Python<'py>,
    rows: &Table,
    unit: LengthUnit,
) -> PyResult<Bound<'py, PyAny>> {
    table(py, &rows.to_csv(), &rows.columns, unit)
}
