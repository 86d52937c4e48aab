//! Many estimates of one kind.

use numpy::PyArray1;
use palpate::recorded::RecordedError;
use pyo3::exceptions::{PyAttributeError, PyIndexError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::Value as Json;

use crate::arrays::array;
use crate::error;
use crate::json::of_json;
use crate::record::Record;

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
    pub(crate) fn of(
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
                .map_err(|error| error.to_string())
        };
        Ok(Self {
            estimates: estimates.into_iter().map(alone).collect(),
            fields: fields.unbind(),
        })
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
        let count = self.estimates.len();
        let from_end = if index < 0 { count as isize } else { 0 };
        let place = usize::try_from(index + from_end).ok();
        match place.and_then(|place| self.estimates.get(place)) {
            Some(Ok(estimate)) => Ok(estimate.bind(py).clone()),
            Some(Err(message)) => Err(error::ReadingsError::new_err(message.clone())),
            None => {
                let message = format!("{index} of a batch of {count} estimates");
                Err(PyIndexError::new_err(message))
            }
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
        let failed = match failed {
            0 => String::new(),
            failed => format!(", {failed} failed"),
        };
        format!("<Batch of {} estimates{failed}>", self.estimates.len())
    }
}
