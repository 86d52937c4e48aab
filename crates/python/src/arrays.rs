//! Arrays of a call, as rows of numbers.

use numpy::{
    PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
    get_array_module,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyList};

use crate::error;

/// Array of an argument, one number after the other, the last axis fastest. It is the caller's own memory where that is so
/// laid out, else a copy.
pub(crate) struct Numbers<'py> {
    name: &'static str,
    shape: Vec<usize>,
    stored: Stored<'py>,
}

/// Where the numbers are.
enum Stored<'py> {
    Shared(PyReadonlyArrayDyn<'py, f64>),
    Copied(Vec<f64>),
}

impl<'py> Numbers<'py> {
    /// Array of an argument: of NumPy, or what NumPy can make one of.
    pub(crate) fn of(name: &'static str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let array = match value.cast::<PyArrayDyn<f64>>() {
            Ok(array) => array.clone(),
            Err(_) => {
                if let Some((numbers, columns)) = rows_of_lists(value) {
                    return Ok(Self {
                        name,
                        shape: vec![numbers.len() / columns, columns],
                        stored: Stored::Copied(numbers),
                    });
                }
                converted(name, value)?
            }
        };
        let busy = |_| {
            let message = format!("{name}: is being written by another thread");
            error::argument(name, &[], None, message)
        };
        let array = array.try_readonly().map_err(busy)?;
        // A slice may also be of an array whose first axis is the fastest.
        let shape = array.shape().to_vec();
        let stored = match array.is_c_contiguous() {
            true => Stored::Shared(array),
            false => Stored::Copied(array.as_array().iter().copied().collect()),
        };
        Ok(Self {
            name,
            shape,
            stored,
        })
    }

    pub(crate) fn shape(&self) -> &[usize] {
        &self.shape
    }

    pub(crate) fn name(&self) -> &'static str {
        self.name
    }

    pub(crate) fn flat(&self) -> &[f64] {
        match &self.stored {
            Stored::Copied(numbers) => numbers,
            // Where it was no slice, it was copied.
            Stored::Shared(array) => array.as_slice().unwrap_or_default(),
        }
    }

    /// Rows of `D` numbers along the last axis; all axes before it run through them.
    pub(crate) fn rows<const D: usize>(&self) -> &[[f64; D]] {
        self.flat().as_chunks::<D>().0
    }

    /// Length of the last of `axes` axes, if it is one of `columns`.
    pub(crate) fn columns(&self, axes: usize, columns: &[usize], wanted: &str) -> PyResult<usize> {
        match self.shape() {
            [.., last] if self.shape().len() == axes && columns.contains(last) => Ok(*last),
            found => Err(error::shape(self.name, wanted, found)),
        }
    }
}

/// Rows of a list of lists of as many floats each, and how many those are; `None` of anything else, which NumPy knows
/// better but takes longer over.
fn rows_of_lists(value: &Bound<'_, PyAny>) -> Option<(Vec<f64>, usize)> {
    let rows = value.cast_exact::<PyList>().ok()?;
    let mut numbers = Vec::new();
    let mut columns = 0;
    for row in rows.iter() {
        let row = row.cast_into_exact::<PyList>().ok()?;
        if columns == 0 {
            columns = row.len();
            numbers.reserve(columns * rows.len());
        }
        if row.len() != columns {
            return None;
        }
        for item in row.iter() {
            numbers.push(item.cast_exact::<PyFloat>().ok()?.value());
        }
    }
    (columns > 0).then_some((numbers, columns))
}

/// Array of doubles that NumPy makes of a value.
fn converted<'py>(
    name: &'static str,
    value: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = value.py();
    let numpy = get_array_module(py)?;
    let no_array = |reason: String| {
        let message = format!("{name}: is no array of numbers: {reason}");
        error::argument(name, &[], None, message)
    };
    let refused = |error: PyErr| no_array(error.value(py).to_string());
    let array = numpy.call_method1("asarray", (value,)).map_err(refused)?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !"biufO".contains(kind.as_str()) {
        let kind = array.getattr("dtype")?.to_string();
        return Err(no_array(format!("its type is {kind}")));
    }
    let copy = PyDict::new(py);
    copy.set_item("copy", false)?;
    let array = array
        .call_method("astype", ("f8",), Some(&copy))
        .map_err(refused)?;
    Ok(array.cast_into::<PyArrayDyn<f64>>()?)
}

/// Whole numbers from 0, of an array.
pub(crate) fn whole(numbers: &Numbers<'_>) -> PyResult<Vec<u64>> {
    let whole = |(place, &number): (usize, &f64)| {
        let is_whole = number >= 0.0 && number.fract() == 0.0 && number < 1e15;
        is_whole.then_some(number as u64).ok_or_else(|| {
            let name = numbers.name();
            let message = format!("{name}[{place}]: must be a whole number from 0, is {number}");
            error::argument(name, &[place], Some(number), message)
        })
    };
    numbers.flat().iter().enumerate().map(whole).collect()
}

/// NumPy's array of these numbers, in this shape.
pub(crate) fn array<'py>(
    py: Python<'py>,
    numbers: Vec<f64>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let flat = PyArray1::from_vec(py, numbers);
    Ok(flat.reshape(shape)?.into_any())
}
