//! Converts arguments that are arrays to rows of numbers.

use numpy::{
    PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods,
    get_array_module,
};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyList};

use crate::error;

/// Numbers of an array argument, in C order (the last axis varies fastest). An array of the caller that already has
/// this order is used without a copy; other arrays are copied.
pub(crate) struct Numbers<'py> {
    name: &'static str,
    data: Data<'py>,
}

enum Data<'py> {
    Array(PyReadonlyArrayDyn<'py, f64>),
    /// Numbers and shape of a list of lists.
    Lists(Vec<f64>, [usize; 2]),
}

impl<'py> Numbers<'py> {
    /// Reads the array of an argument. It may be a NumPy array, or any object that NumPy converts to an array.
    pub(crate) fn of(name: &'static str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let array = match value.cast::<PyArrayDyn<f64>>() {
            Ok(array) if array.is_c_contiguous() => array.clone(),
            _ => match rows_of_lists(value) {
                Some((numbers, shape)) => {
                    let data = Data::Lists(numbers, shape);
                    return Ok(Self { name, data });
                }
                None => converted(name, value)?,
            },
        };
        let busy = |_| {
            let message = format!("{name}: another thread writes into this array");
            error::argument(name, &[], None, message)
        };
        let data = Data::Array(array.try_readonly().map_err(busy)?);
        Ok(Self { name, data })
    }

    pub(crate) fn shape(&self) -> &[usize] {
        match &self.data {
            Data::Array(array) => array.shape(),
            Data::Lists(_, shape) => shape,
        }
    }

    pub(crate) fn name(&self) -> &'static str {
        self.name
    }

    pub(crate) fn flat(&self) -> &[f64] {
        match &self.data {
            Data::Array(array) => array.as_slice().unwrap_or_default(),
            Data::Lists(numbers, _) => numbers,
        }
    }

    /// The numbers as rows. A row consists of the `D` numbers along the last axis; all other axes are joined to one.
    pub(crate) fn rows<const D: usize>(&self) -> &[[f64; D]] {
        self.flat().as_chunks::<D>().0
    }

    /// Number of sets of readings, and number of columns. A two-dimensional array is a single set; its number of sets
    /// is `None`. The number of columns must be one of `columns`. If the shape of the array is wrong, the error states
    /// the right shape, `wanted`.
    pub(crate) fn sets(&self, columns: &[usize], wanted: &str) -> PyResult<(Option<usize>, usize)> {
        match *self.shape() {
            [_, last] if columns.contains(&last) => Ok((None, last)),
            [sets, _, last] if columns.contains(&last) => Ok((Some(sets), last)),
            _ => Err(error::shape(self.name, wanted, self.shape())),
        }
    }

    /// Rows of one set of readings. If the array is a single set, all rows are returned.
    pub(crate) fn set<const D: usize>(&self, set: usize) -> &[[f64; D]] {
        match *self.shape() {
            [_, rows, _] => &self.rows()[set * rows..][..rows],
            _ => self.rows(),
        }
    }
}

/// Numbers and shape of a list of lists of floats; all inner lists must have the same length. The result is `None` for
/// any other object. For short lists, this function is faster than NumPy.
fn rows_of_lists(value: &Bound<'_, PyAny>) -> Option<(Vec<f64>, [usize; 2])> {
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
    (columns > 0).then_some((numbers, [rows.len(), columns]))
}

fn converted<'py>(
    name: &'static str,
    value: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = value.py();
    let numpy = get_array_module(py)?;
    let no_array = |reason: String| {
        let message = format!("{name}: must be an array of numbers: {reason}");
        error::argument(name, &[], None, message)
    };
    let refused = |error: PyErr| no_array(error.value(py).to_string());
    let array = numpy.call_method1("asarray", (value,)).map_err(refused)?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !"biufO".contains(kind.as_str()) {
        let kind = array.getattr("dtype")?.to_string();
        return Err(no_array(format!("its type is {kind}")));
    }
    let array = numpy.call_method1("ascontiguousarray", (array, "f8"));
    Ok(array.map_err(refused)?.cast_into()?)
}

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

pub(crate) fn array<'py>(
    py: Python<'py>,
    numbers: Vec<f64>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let flat = PyArray1::from_vec(py, numbers);
    Ok(flat.reshape(shape)?.into_any())
}
