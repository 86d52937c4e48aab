//! Tables of results, column by column.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, RecordBatchIterator, StringArray};
use arrow_schema::{ArrowError, DataType, Field, Schema};
use numpy::PyArray1;
use palpate::config::LengthUnit;
use palpate::{Column, Values, columns_of_csv};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyCapsule, PyDict, PyIterator, PyList};

use crate::error;
use crate::estimate::length_unit;

/// Table of results: a mapping of the names of its columns to arrays of one value per row, numbers as float64 with NaN for
/// an empty field.
///
/// `polars.DataFrame(table)`, `pandas.DataFrame.from_arrow(table)` and `pyarrow.table(table)` read it through the Arrow
/// PyCapsule interface, units as metadata of the fields `unit`, empty numbers as null; `pandas.DataFrame(dict(table))`
/// takes its arrays.
#[pyclass(frozen, mapping, module = "palpate")]
pub(crate) struct Table {
    csv: String,
    unit: LengthUnit,
    header: Vec<String>,
    height: usize,
    /// Arrays by name, once they were asked for.
    arrays: PyOnceLock<Py<PyDict>>,
}

/// Error of a text that is no table.
fn refused(error: impl std::fmt::Display) -> PyErr {
    error::RunError::new_err(format!("no table: {error}"))
}

impl Table {
    /// Table of a CSV text with lengths in this unit.
    pub(crate) fn new(csv: String, unit: LengthUnit) -> PyResult<Self> {
        let mut reader = csv::Reader::from_reader(csv.as_bytes());
        let header = reader.headers().map_err(refused)?;
        let header = header.iter().map(str::to_owned).collect();
        let mut height = 0;
        let mut record = csv::ByteRecord::new();
        while reader.read_byte_record(&mut record).map_err(refused)? {
            height += 1;
        }
        Ok(Self {
            csv,
            unit,
            header,
            height,
            arrays: PyOnceLock::new(),
        })
    }

    pub(crate) fn csv(&self) -> &str {
        &self.csv
    }

    fn read(&self) -> PyResult<Vec<Column>> {
        columns_of_csv(&self.csv, self.unit).map_err(refused)
    }

    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyDict>> {
        let arrays = self.arrays.get_or_try_init(py, || {
            let by_name = PyDict::new(py);
            for column in self.read()? {
                match column.values {
                    Values::Numbers(numbers) => {
                        let numbers = numbers.into_iter().map(|one| one.unwrap_or(f64::NAN));
                        by_name.set_item(column.name, PyArray1::from_vec(py, numbers.collect()))?;
                    }
                    Values::Texts(texts) => {
                        let texts = py.import("numpy")?.call_method1("array", (texts, "str"))?;
                        by_name.set_item(column.name, texts)?;
                    }
                }
            }
            Ok::<_, PyErr>(by_name.unbind())
        })?;
        Ok(arrays.bind(py))
    }

    /// Table in the memory layout of Arrow.
    fn batch(&self) -> PyResult<RecordBatch> {
        let columns = self.read()?.into_iter().map(|column| {
            let (kind, values): (DataType, ArrayRef) = match column.values {
                Values::Numbers(numbers) => {
                    (DataType::Float64, Arc::new(Float64Array::from(numbers)))
                }
                Values::Texts(texts) => (DataType::Utf8, Arc::new(StringArray::from(texts))),
            };
            let unit = column.unit.map(|unit| ("unit".to_owned(), unit));
            let metadata: HashMap<String, String> = unit.into_iter().collect();
            let field = Field::new(column.name, kind, true);
            (field.with_metadata(metadata), values)
        });
        let (fields, values): (Vec<Field>, Vec<ArrayRef>) = columns.unzip();
        RecordBatch::try_new(Arc::new(Schema::new(fields)), values).map_err(refused)
    }
}

#[pymethods]
impl Table {
    fn __len__(&self) -> usize {
        self.header.len()
    }

    fn __contains__(&self, name: &str) -> bool {
        self.header.iter().any(|own| own == name)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        self.keys(py)?.try_iter()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let column = self.arrays(py)?.get_item(name)?;
        column.ok_or_else(|| {
            let known = self.header.join(", ");
            PyKeyError::new_err(format!("no column {name:?}; there are {known}"))
        })
    }

    /// Names of the columns, which end with their units.
    fn keys<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        PyList::new(py, &self.header)
    }

    /// Arrays of the columns.
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        Ok(self.arrays(py)?.values())
    }

    /// Names of the columns with their arrays.
    fn items<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        Ok(self.arrays(py)?.items())
    }

    /// Array of a column, or `default` where there is no such column.
    #[pyo3(signature = (key, default=None, /))]
    fn get<'py>(
        &self,
        py: Python<'py>,
        key: &str,
        default: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(self.arrays(py)?.get_item(key)?.or(default))
    }

    /// Number of rows.
    #[getter]
    pub(crate) fn height(&self) -> usize {
        self.height
    }

    /// Unit of each column by its name; None where it has none, or each row its own.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for column in self.read()? {
            units.set_item(column.name, column.unit)?;
        }
        Ok(units)
    }

    /// Arrays by the names of their columns.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.arrays(py)?.copy()
    }

    /// The table as CSV: the bytes that the command line writes.
    fn to_csv(&self) -> &str {
        &self.csv
    }

    /// The table as a stream of the Arrow C data interface, in a capsule; `requested_schema` is not looked at.
    #[pyo3(signature = (requested_schema=None))]
    pub(crate) fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        drop(requested_schema);
        let batch = self.batch()?;
        let schema = batch.schema();
        let batches = RecordBatchIterator::new([Ok::<_, ArrowError>(batch)], schema);
        let stream = FFI_ArrowArrayStream::new(Box::new(batches));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.csv == other.csv && self.unit == other.unit
    }

    #[staticmethod]
    fn _restored(csv: String, unit: &str) -> PyResult<Self> {
        Self::new(csv, length_unit(Some(unit))?.unwrap_or_default())
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (String, &'static str))> {
        let own = slf.get();
        let state = (own.csv.clone(), own.unit.as_str());
        Ok((slf.get_type().getattr("_restored")?, state))
    }

    fn __repr__(&self) -> String {
        format!(
            "<Table of {} rows: {}>",
            self.height,
            self.header.join(", ")
        )
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let own = slf.get();
        let mut reader = csv::Reader::from_reader(own.csv.as_bytes());
        let rows = reader.records().take(20).map(|row| {
            let row = row.map_err(refused)?;
            Ok(row.iter().map(str::to_owned).collect::<Vec<String>>())
        });
        let rows = rows.collect::<PyResult<Vec<_>>>()?;
        let state = (own.header.clone(), rows, own.height);
        slf.py()
            .import("palpate._show")?
            .call_method1("table", state)
    }
}
