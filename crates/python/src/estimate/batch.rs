//! Many estimates of one kind.

use numpy::PyArray1;
use palpate::recorded::RecordedError;
use pyo3::exceptions::{PyAttributeError, PyIndexError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rayon::prelude::*;
use serde_json::Value as Json;

use crate::arrays::array;
use crate::error;
use crate::json::of_json;
use crate::record::Record;
use crate::watch::{pool, watched};

/// Estimates of many sets of readings, in their order.
///
/// A field of the batch is that field of all its estimates: numbers as an array of float64 with NaN where an estimate has
/// none, lists of as many numbers as an array with a row each, all else as a list. `batch[i]` is one estimate, and raises
/// why there is none.
#[pyclass(frozen, sequence, module = "palpate")]
pub(crate) struct Batch {
    /// Estimates, or the errors in their place.
    estimates: Vec<Result<Py<PyAny>, String>>,
    fields: Py<PyDict>,
}

impl Batch {
    /// Batch of estimates with their fields as JSON.
    fn of(
        py: Python<'_>,
        estimates: Vec<Result<(Bound<'_, PyAny>, Json), RecordedError>>,
    ) -> PyResult<Self> {
        let fields: Vec<Option<&Json>> = estimates
            .iter()
            .map(|one| one.as_ref().ok().map(|(_, fields)| fields))
            .collect();
        let fields = stacked(py, &fields)?.cast_into::<PyDict>();
        let fields = fields.unwrap_or_else(|_| PyDict::new(py));
        let alone = |one: Result<(Bound<'_, PyAny>, Json), RecordedError>| {
            one.map(|(estimate, _)| estimate.unbind())
                .map_err(|error| error::text(&error))
        };
        Ok(Self {
            estimates: estimates.into_iter().map(alone).collect(),
            fields: fields.unbind(),
        })
    }
}

/// Place of an index in a batch, which may count from its end.
pub(super) fn place(index: isize, count: usize) -> PyResult<usize> {
    let from_end = if index < 0 { count as isize } else { 0 };
    let place = usize::try_from(index + from_end).ok();
    place.filter(|place| *place < count).ok_or_else(|| {
        let message = format!("{index} of a batch of {count} estimates");
        PyIndexError::new_err(message)
    })
}

/// Words for a batch.
pub(super) fn words(kind: &str, count: usize, failed: usize) -> String {
    let failed = match failed {
        0 => String::new(),
        failed => format!(", {failed} failed"),
    };
    format!("<{kind} of {count} estimates{failed}>")
}

/// Batch of estimates from sets of readings, which threads make without the interpreter's lock. `estimate` makes one with
/// its fields as JSON, `shown` hands it out.
pub(super) fn batch<'py, R: Sync, E: Send>(
    py: Python<'py>,
    sets: &[R],
    threads: Option<usize>,
    estimate: impl Fn(&R) -> Result<(E, Json), RecordedError> + Sync,
    shown: impl Fn(E) -> PyResult<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let pool = pool(threads)?;
    let made: Vec<Result<(E, Json), RecordedError>> = watched(py, |watch| {
        pool.install(|| {
            let going = sets.par_iter().filter(|_| !watch.is_cancelled());
            going.map(&estimate).collect()
        })
    })?;
    let shown = made.into_iter().map(|one| match one {
        Ok((estimate, fields)) => Ok(Ok((shown(estimate)?, fields))),
        Err(error) => Ok(Err(error)),
    });
    let batch = Batch::of(py, shown.collect::<PyResult<_>>()?)?;
    Ok(Bound::new(py, batch)?.into_any())
}

/// Error of an array with the number of the set before the place in it.
pub(super) fn in_set(set: usize, error: RecordedError) -> RecordedError {
    match error {
        RecordedError::Array {
            array,
            index,
            value,
            message,
        } => RecordedError::Array {
            array,
            index: std::iter::once(set).chain(index).collect(),
            value,
            message,
        },
        error => error,
    }
}

/// Fields of many tables, each with the values of all of them; where there is no table, there is no value.
fn stacked<'py>(py: Python<'py>, all: &[Option<&Json>]) -> PyResult<Bound<'py, PyAny>> {
    let first = all.iter().flatten().find(|one| !one.is_null());
    match first {
        Some(Json::Object(table)) => {
            let dict = PyDict::new(py);
            for key in table.keys() {
                let of_key: Vec<Option<&Json>> = all
                    .iter()
                    .map(|one| one.and_then(|one| one.get(key)))
                    .collect();
                dict.set_item(key, stacked(py, &of_key)?)?;
            }
            Ok(dict.into_any())
        }
        Some(Json::Number(_)) => {
            let numbers = all.iter().map(|one| number(*one));
            Ok(PyArray1::from_vec(py, numbers.collect()).into_any())
        }
        Some(Json::Array(items)) if is_row(all, items.len()) => {
            let columns = items.len();
            let row = |one: &Option<&Json>| match one {
                Some(Json::Array(row)) => row.iter().map(|item| number(Some(item))).collect(),
                _ => vec![f64::NAN; columns],
            };
            let numbers: Vec<f64> = all.iter().flat_map(row).collect();
            array(py, numbers, &[all.len(), columns])
        }
        _ => {
            let list = PyList::empty(py);
            for one in all {
                list.append(of_json(py, one.unwrap_or(&Json::Null))?)?;
            }
            Ok(list.into_any())
        }
    }
}

/// Whether all are lists of so many numbers, as far as they are there.
fn is_row(all: &[Option<&Json>], columns: usize) -> bool {
    let is_number = |item: &Json| item.is_number() || item.is_null();
    let is_good = |one: &Json| match one {
        Json::Array(row) => row.len() == columns && row.iter().all(is_number),
        other => other.is_null(),
    };
    columns > 0 && all.iter().copied().flatten().all(is_good)
}

fn number(json: Option<&Json>) -> f64 {
    json.and_then(Json::as_f64)
        .map_or(f64::NAN, |number| number + 0.0)
}

#[pymethods]
impl Batch {
    fn __len__(&self) -> usize {
        self.estimates.len()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, index: isize) -> PyResult<Bound<'py, PyAny>> {
        match &self.estimates[place(index, self.estimates.len())?] {
            Ok(estimate) => Ok(estimate.bind(py).clone()),
            Err(message) => Err(error::ReadingsError::new_err(message.clone())),
        }
    }

    /// Why estimates are missing, by their numbers.
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
        match self.fields.bind(py).get_item(name)? {
            Some(value) => match value.cast::<PyDict>() {
                Ok(table) => {
                    let record = Record::restored(table.clone(), None);
                    Ok(Bound::new(py, record)?.into_any())
                }
                Err(_) => Ok(value),
            },
            None => Err(PyAttributeError::new_err(format!(
                "Batch has no field {name:?}"
            ))),
        }
    }

    fn __dir__(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let mut names: Vec<String> = ["errors", "to_dict"].map(str::to_owned).into();
        for name in self.fields.bind(py).keys() {
            names.push(name.extract()?);
        }
        Ok(names)
    }

    /// Fields as a dictionary of arrays, lists and dictionaries of them.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let copy = py.import("copy")?.getattr("deepcopy")?;
        copy.call1((self.fields.bind(py),))
    }

    #[staticmethod]
    fn _restored(
        estimates: Vec<(Option<Py<PyAny>>, Option<String>)>,
        fields: Bound<'_, PyDict>,
    ) -> Self {
        let one = |(estimate, error): (Option<Py<PyAny>>, Option<String>)| match estimate {
            Some(estimate) => Ok(estimate),
            None => Err(error.unwrap_or_default()),
        };
        Self {
            estimates: estimates.into_iter().map(one).collect(),
            fields: fields.unbind(),
        }
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, own) = (slf.py(), slf.get());
        let estimates = PyList::empty(py);
        for one in &own.estimates {
            match one {
                Ok(estimate) => estimates.append((estimate.bind(py), py.None()))?,
                Err(message) => estimates.append((py.None(), message))?,
            }
        }
        let restored = slf.get_type().getattr("_restored")?;
        let state = (estimates, own.fields.bind(py).clone());
        Ok((restored, state.into_pyobject(py)?.into_any()))
    }

    fn __repr__(&self) -> String {
        let failed = self.estimates.iter().filter(|one| one.is_err()).count();
        words("Batch", self.estimates.len(), failed)
    }
}
