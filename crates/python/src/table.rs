//! Tables of results, column by column.

use numpy::PyArray1;
use palpate::config::LengthUnit;
use palpate::{Values, columns_of_csv};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error;

/// Table of a CSV text with lengths in this unit: a `palpate.Table`, which is a dict of arrays.
pub(crate) fn table(py: Python<'_>, csv: &str, unit: LengthUnit) -> PyResult<Py<PyAny>> {
    let columns = columns_of_csv(csv, unit)
        .map_err(|error| error::RunError::new_err(format!("no table: {error}")))?;
    let (arrays, units) = (PyDict::new(py), PyDict::new(py));
    for column in columns {
        let name = column.stem(unit);
        match column.values {
            Values::Numbers(ref numbers) => {
                let numbers = numbers.iter().map(|number| number.unwrap_or(f64::NAN));
                arrays.set_item(name, PyArray1::from_iter(py, numbers))?;
            }
            Values::Texts(ref texts) => {
                let texts = py.import("numpy")?.call_method1("array", (texts, "str"))?;
                arrays.set_item(name, texts)?;
            }
        }
        units.set_item(name, &column.unit)?;
    }
    let class = py.import("palpate._table")?.getattr("Table")?;
    Ok(class.call1((arrays, units, csv))?.unbind())
}

/// The CSV text that a table was made of.
pub(crate) fn csv_of(py: Python<'_>, table: &Py<PyAny>) -> PyResult<String> {
    table.call_method0(py, "to_csv")?.extract(py)
}
