//! Tables of results, column by column.

use numpy::PyArray1;
use palpate::config::LengthUnit;
use palpate::{Table as Rows, Values, columns};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyIterator, PyList};

use crate::estimate::length_unit;

/// Table of results: a mapping of the names of its columns to arrays of one value per row, numbers as float64 with NaN for
/// an empty field. `pandas.DataFrame(dict(table))` and `polars.DataFrame(dict(table))` take it as it is.
#[pyclass(frozen, mapping, module = "palpate")]
pub(crate) struct Table {
    rows: Rows,
    unit: LengthUnit,
    columns: Py<PyDict>,
    units: Py<PyDict>,
}

impl Table {
    pub(crate) fn new(py: Python<'_>, rows: Rows, unit: LengthUnit) -> PyResult<Self> {
        let (by_name, units) = (PyDict::new(py), PyDict::new(py));
        for column in columns(&rows, unit) {
            match column.values {
                Values::Numbers(numbers) => {
                    let numbers = numbers.into_iter().map(|one| one.unwrap_or(f64::NAN));
                    let numbers = PyArray1::from_vec(py, numbers.collect());
                    by_name.set_item(&column.name, numbers)?;
                }
                Values::Texts(texts) => {
                    let texts = py.import("numpy")?.call_method1("array", (texts,))?;
                    by_name.set_item(&column.name, texts)?;
                }
            }
            units.set_item(column.name, column.unit)?;
        }
        Ok(Self {
            rows,
            unit,
            columns: by_name.unbind(),
            units: units.unbind(),
        })
    }

    pub(crate) fn rows(&self) -> &Rows {
        &self.rows
    }
}

#[pymethods]
impl Table {
    fn __len__(&self) -> usize {
        self.rows.header.len()
    }

    fn __contains__(&self, py: Python<'_>, name: &str) -> PyResult<bool> {
        self.columns.bind(py).contains(name)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        self.keys(py).try_iter()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let column = self.columns.bind(py).get_item(name)?;
        column.ok_or_else(|| {
            let known = self.rows.header.join(", ");
            PyKeyError::new_err(format!("no column {name:?}; there are {known}"))
        })
    }

    /// Names of the columns, which end with their units.
    fn keys<'py>(&self, py: Python<'py>) -> Bound<'py, PyList> {
        self.columns.bind(py).keys()
    }

    /// Number of rows.
    #[getter]
    fn height(&self) -> usize {
        self.rows.rows.len()
    }

    /// Unit of each column by its name; None where it has none, or each row its own.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.units.bind(py).copy()
    }

    /// Arrays by the names of their columns.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.columns.bind(py).copy()
    }

    /// The table as CSV: the bytes that the command line writes.
    fn to_csv(&self) -> String {
        self.rows.to_csv()
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.rows == other.rows && self.unit == other.unit
    }

    #[staticmethod]
    fn _restored(
        py: Python<'_>,
        header: Vec<String>,
        rows: Vec<Vec<String>>,
        unit: &str,
    ) -> PyResult<Self> {
        let unit = length_unit(Some(unit))?.unwrap_or_default();
        Self::new(py, Rows { header, rows }, unit)
    }

    #[allow(clippy::type_complexity)]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(
        Bound<'py, PyAny>,
        (Vec<String>, Vec<Vec<String>>, &'static str),
    )> {
        let own = slf.get();
        let state = (
            own.rows.header.clone(),
            own.rows.rows.clone(),
            own.unit.as_str(),
        );
        Ok((slf.get_type().getattr("_restored")?, state))
    }

    fn __repr__(&self) -> String {
        let (rows, names) = (self.rows.rows.len(), self.rows.header.join(", "));
        format!("<Table of {rows} rows: {names}>")
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let own = slf.get();
        let shown = own.rows.rows.iter().take(20).cloned().collect::<Vec<_>>();
        let state = (own.rows.header.clone(), shown, own.rows.rows.len());
        slf.py()
            .import("palpate._show")?
            .call_method1("table", state)
    }
}
