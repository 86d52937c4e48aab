//! Batches: estimates of the same kind for many sets of readings.

use std::sync::Arc;

use numpy::PyArray1;
use palpate::recorded::RecordedError;
use pyo3::exceptions::{PyAttributeError, PyIndexError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyList, PyTuple};
use rayon::prelude::*;

use crate::arrays::array;
use crate::error;
use crate::record::{Alone, Made, Record, number};
use crate::watch::{pool, watched};

/// Estimates for many sets of readings, in the order of the sets.
///
/// `batch[i]` is the estimate for set i, or raises the error of its readings. Each field of an estimate is also a
/// field of the batch, with the values of all estimates. Numbers become an array of float64, with NaN if an estimate
/// has no number. Lists of numbers become an array with one row per estimate if they have the same length. The unit is
/// stored once, and all other values become a list. A field of the batch is None if no estimate has this field.
#[pyclass(frozen, sequence, module = "palpate")]
pub(crate) struct Batch {
    /// One entry per set of readings: the estimate, or the error message if there is no estimate.
    estimates: Vec<Result<Member, String>>,
}

/// Function that converts a record to a Python object of the class of its estimate, for example `PressEstimate`.
type Class = fn(Python<'_>, Record) -> PyResult<Bound<'_, PyAny>>;

enum Member {
    /// An estimate that palpate computed: its value in the library, the function that converts it to a Python object,
    /// and this object. The object is made when Python reads it for the first time.
    Made(Arc<dyn Made>, Class, PyOnceLock<Py<Record>>),
    Restored(Py<Record>),
}

impl Member {
    fn object(&self, py: Python<'_>) -> PyResult<&Py<Record>> {
        match self {
            Self::Made(made, class, object) => object.get_or_try_init(py, || {
                let record = class(py, Record::shared(Arc::clone(made)))?;
                Ok(record.cast_into()?.unbind())
            }),
            Self::Restored(object) => Ok(object),
        }
    }

    fn fields<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyDict>> {
        self.object(py)?.bind(py).get().fields(py)
    }

    /// Computes one field of this estimate without the other fields. Returns `None` if the field cannot be computed
    /// alone.
    fn alone(&self, name: &str) -> Option<Alone> {
        match self {
            Self::Made(made, ..) => made.alone(name),
            Self::Restored(_) => None,
        }
    }
}

/// Computes estimates for many sets of readings, on several threads and without the interpreter's lock.
pub(super) fn batch<'py, R: Send + 'static, E: Made + 'static>(
    py: Python<'py>,
    sets: Vec<R>,
    threads: Option<usize>,
    estimate: impl Fn(R) -> Result<E, RecordedError> + Send + Sync + 'static,
    class: Class,
) -> PyResult<Bound<'py, PyAny>> {
    let pool = pool(threads)?;
    let member = move |readings: R| match estimate(readings) {
        Ok(made) => Ok(Member::Made(Arc::new(made), class, PyOnceLock::new())),
        Err(error) => Err(error::text(&error)),
    };
    let estimates = watched(py, None, move |watch| {
        pool.install(|| {
            let remaining = sets.into_par_iter().filter(|_| !watch.is_cancelled());
            remaining.map(&member).collect()
        })
    })?;
    Ok(Bound::new(py, Batch { estimates })?.into_any())
}

/// Completes an error about one set of readings. `with_sets` contains the names of the arrays that hold several sets. If
/// the error is about one of these arrays, the number `set` of the set becomes the first index in the error. Other errors
/// do not change.
pub(super) fn in_set(set: usize, with_sets: &[&str], error: RecordedError) -> RecordedError {
    match error {
        RecordedError::Array {
            array,
            index,
            value,
            message,
        } if with_sets.contains(&array) => RecordedError::Array {
            array,
            index: std::iter::once(set).chain(index).collect(),
            value,
            message,
        },
        error => error,
    }
}

/// Combines the values of one field of many estimates into an array, a list or a dictionary. An entry of `all` is
/// `None` if an estimate does not have the field.
fn stacked<'py>(py: Python<'py>, all: &[Option<Bound<'py, PyAny>>]) -> PyResult<Bound<'py, PyAny>> {
    let Some(first) = all.iter().flatten().find(|one| !one.is_none()) else {
        return Ok(py.None().into_bound(py));
    };
    if let Ok(table) = first.cast::<PyDict>() {
        let stack = PyDict::new(py);
        for (key, value) in table.iter() {
            let of_key = |one: &Option<Bound<'py, PyAny>>| match one {
                Some(one) => one.cast::<PyDict>()?.get_item(&key),
                None => Ok(None),
            };
            let of_key = all.iter().map(of_key).collect::<PyResult<Vec<_>>>()?;
            let value = if key.eq("unit")? {
                value
            } else {
                stacked(py, &of_key)?
            };
            stack.set_item(key, value)?;
        }
        return Ok(stack.into_any());
    }
    if number(first).is_some() {
        let number = |one: &Option<Bound<'py, PyAny>>| number(one.as_ref()?);
        let numbers = all.iter().map(|one| number(one).unwrap_or(f64::NAN));
        return Ok(PyArray1::from_vec(py, numbers.collect()).into_any());
    }
    if let Some(columns) = row(first).map(|row| row.len()).filter(|count| *count > 0) {
        let of_set = |one: &Option<Bound<'py, PyAny>>| match one {
            Some(one) if !one.is_none() => row(one).filter(|row| row.len() == columns),
            _ => Some(vec![f64::NAN; columns]),
        };
        if let Some(rows) = all.iter().map(of_set).collect::<Option<Vec<_>>>() {
            return array(py, rows.concat(), &[all.len(), columns]);
        }
    }
    Ok(PyList::new(py, all)?.into_any())
}

fn row(value: &Bound<'_, PyAny>) -> Option<Vec<f64>> {
    let list = value.cast::<PyList>().ok()?;
    list.iter().map(|item| number(&item)).collect()
}

/// Combines the values of one field of many estimates into an array. The values were computed without the other fields,
/// to save time. An entry of `all` is `None` if an estimate does not have the field.
fn of_alone(py: Python<'_>, all: Vec<Option<Alone>>) -> PyResult<Bound<'_, PyAny>> {
    let mut rows = Vec::with_capacity(all.len());
    let mut unit = None;
    for one in all {
        rows.push(match one {
            Some(Alone::Number(number)) => [number.unwrap_or(f64::NAN); 4],
            Some(Alone::Value(value)) => {
                unit = Some(value.unit);
                let [low, high] = value
                    .interval95
                    .unwrap_or_default()
                    .map(|end| end.unwrap_or(f64::NAN));
                let or_nan = |number: Option<f64>| number.unwrap_or(f64::NAN);
                [or_nan(value.value), or_nan(value.std), low, high]
            }
            None => [f64::NAN; 4],
        });
    }
    let column = |column: usize| {
        let numbers: Vec<f64> = rows.iter().map(|row| row[column]).collect();
        let is_known = numbers.iter().any(|number| !number.is_nan());
        is_known.then(|| PyArray1::from_vec(py, numbers).into_any())
    };
    let Some(unit) = unit else {
        return Ok(column(0).into_pyobject(py)?.into_any());
    };
    let fields = PyDict::new(py);
    fields.set_item("value", column(0))?;
    fields.set_item("std", column(1))?;
    let ends = rows.iter().flat_map(|row| [row[2], row[3]]).collect();
    let interval = column(2).map(|_| array(py, ends, &[rows.len(), 2]));
    fields.set_item("interval95", interval.transpose()?)?;
    fields.set_item("unit", unit)?;
    Ok(fields.into_any())
}

impl Batch {
    fn names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        match self.estimates.iter().flatten().next() {
            Some(first) => Ok(first.fields(py)?.keys()),
            None => Ok(PyList::empty(py)),
        }
    }

    /// Values of one field in all estimates; `None` if no estimate has this field.
    fn field<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let first = self.estimates.iter().flatten().next();
        if first.is_some_and(|first| first.alone(name).is_some()) {
            let alone = |one: &Result<Member, _>| one.as_ref().ok()?.alone(name);
            return of_alone(py, self.estimates.iter().map(alone).collect()).map(Some);
        }
        let field = |one: &Result<Member, _>| match one {
            Ok(estimate) => estimate.fields(py)?.get_item(name),
            Err(_) => Ok(None),
        };
        let all = self
            .estimates
            .iter()
            .map(field)
            .collect::<PyResult<Vec<_>>>()?;
        let is_field = all.iter().any(Option::is_some);
        is_field.then(|| stacked(py, &all)).transpose()
    }
}

#[pymethods]
impl Batch {
    #[new]
    fn new(estimates: Vec<(Option<Py<Record>>, String)>) -> Self {
        let one = |(estimate, error): (Option<_>, _)| estimate.map(Member::Restored).ok_or(error);
        Self {
            estimates: estimates.into_iter().map(one).collect(),
        }
    }

    fn __len__(&self) -> usize {
        self.estimates.len()
    }

    fn __getitem__(&self, py: Python<'_>, index: isize) -> PyResult<Py<Record>> {
        let count = self.estimates.len();
        let from_end = if index < 0 { count as isize } else { 0 };
        let place = usize::try_from(index + from_end).ok();
        match place.and_then(|place| self.estimates.get(place)) {
            Some(Ok(estimate)) => Ok(estimate.object(py)?.clone_ref(py)),
            Some(Err(message)) => Err(error::ReadingsError::new_err(message.clone())),
            None => {
                let message = format!("index {index} of a batch of {count} estimates");
                Err(PyIndexError::new_err(message))
            }
        }
    }

    /// Dictionary of error messages. The keys are the numbers of the sets that have no estimate.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let errors = PyDict::new(py);
        for (place, one) in self.estimates.iter().enumerate() {
            if let Err(message) = one {
                errors.set_item(place, message)?;
            }
        }
        Ok(errors)
    }

    fn __getattr__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let value = self.field(py, name.strip_suffix('_').unwrap_or(name))?;
        let value = value.ok_or_else(|| {
            PyAttributeError::new_err(format!("the estimates of the batch have no field {name:?}"))
        })?;
        match value.cast::<PyDict>() {
            Ok(table) => {
                let record = Record::restored(table.clone(), None);
                Ok(Bound::new(py, record)?.into_any())
            }
            Err(_) => Ok(value),
        }
    }

    fn __dir__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let names = self.names(py)?;
        names.append("errors")?;
        names.append("to_dict")?;
        Ok(names)
    }

    /// The fields of the batch as a dictionary of arrays, lists and dictionaries.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let fields = PyDict::new(py);
        for name in self.names(py)? {
            fields.set_item(&name, self.field(py, &name.extract::<String>()?)?)?;
        }
        Ok(fields)
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let py = slf.py();
        let one = |one: &Result<Member, String>| match one {
            Ok(estimate) => Ok((Some(estimate.object(py)?.clone_ref(py)), String::new())),
            Err(message) => Ok((None, message.clone())),
        };
        let estimates = slf.get().estimates.iter().map(one);
        let estimates = estimates.collect::<PyResult<Vec<_>>>()?;
        Ok((slf.get_type().into_any(), PyTuple::new(py, [estimates])?))
    }

    fn __repr__(&self) -> String {
        let failed = self.estimates.iter().filter(|one| one.is_err()).count();
        let failed = match failed {
            0 => String::new(),
            failed => format!(", {failed} failed"),
        };
        format!("<Batch of {} estimates{failed}>", self.estimates.len())
    }
}
