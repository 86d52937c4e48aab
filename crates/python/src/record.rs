//! Defines the results of functions, which have named fields.

use std::sync::Arc;

use palpate::Warning;
use palpate::recorded::Value;
use pyo3::exceptions::{PyAttributeError, PyKeyError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PySet, PyTuple, PyType};
use serde::Serialize;

use crate::json::to_python;

/// A result of the library. In Python, it is an object with fields, and a field is computed only when Python reads it.
pub(crate) trait Made: Send + Sync {
    /// All fields of the result that are also in the JSON of the command line.
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>>;

    /// Computes one field without the others. Returns `None` if computing the field alone is not much faster than
    /// computing all fields.
    fn alone(&self, _: &str) -> Option<Alone> {
        None
    }

    /// Names of the fields that are not part of the JSON: arrays, tables and figures.
    fn others(&self) -> &'static [&'static str] {
        &[]
    }

    /// Value of one of the fields in [`Self::others`].
    fn other<'py>(&self, _: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        Err(PyAttributeError::new_err(name.to_owned()))
    }
}

/// An estimated quantity. Its fields `value` and `std` can be read without computing its other fields.
impl Made for Value {
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, self)
    }

    fn alone(&self, name: &str) -> Option<Alone> {
        match name {
            "value" => Some(Alone::Number(self.value)),
            "std" => Some(Alone::Number(self.std)),
            _ => None,
        }
    }
}

/// Value of a field that [`Made::alone`] computed, without computing the other fields of the result.
pub(crate) enum Alone {
    Number(Option<f64>),
    Value(Value),
}

/// Result with named fields.
///
/// A field that is a table is a `Record` too. A list of numbers becomes an array of float64, with NaN for a missing
/// number. `float(record)` is the field `value`. `record["name"]` returns any field, even if its name is not a valid
/// attribute name.
#[pyclass(subclass, frozen, module = "palpate")]
pub(crate) struct Record {
    made: Option<Arc<dyn Made>>,
    fields: PyOnceLock<Py<PyDict>>,
    arrays: PyOnceLock<Py<PyDict>>,
}

impl Record {
    pub(crate) fn new(made: impl Made + 'static) -> Self {
        Self::shared(Arc::new(made))
    }

    pub(crate) fn shared(made: Arc<dyn Made>) -> Self {
        Self {
            made: Some(made),
            fields: PyOnceLock::new(),
            arrays: PyOnceLock::new(),
        }
    }

    pub(crate) fn restored(fields: Bound<'_, PyDict>, arrays: Option<Bound<'_, PyDict>>) -> Self {
        let py = fields.py();
        let lock = |dict: Option<Bound<'_, PyDict>>| {
            let lock = PyOnceLock::new();
            if let Some(dict) = dict {
                lock.get_or_init(py, || dict.unbind());
            }
            lock
        };
        Self {
            made: None,
            fields: lock(Some(fields)),
            arrays: lock(arrays),
        }
    }

    pub(crate) fn of<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
        field(to_python(py, value)?)
    }

    pub(crate) fn fields<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyDict>> {
        let fields = self.fields.get_or_try_init(py, || match &self.made {
            Some(made) => Ok(made.fields(py)?.cast_into::<PyDict>()?.unbind()),
            None => Ok::<_, PyErr>(PyDict::new(py).unbind()),
        })?;
        Ok(fields.bind(py))
    }

    /// Value of the field with this name; `None` if there is no such field.
    fn field<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let value = match self.made.as_ref().and_then(|made| made.alone(name)) {
            Some(Alone::Number(number)) => return Ok(Some(number.into_pyobject(py)?)),
            Some(Alone::Value(value)) => {
                return Ok(Some(Bound::new(py, Self::new(value))?.into_any()));
            }
            None => match self.array(py, name)? {
                Some(value) => Some(value),
                None => self.fields(py)?.get_item(name)?,
            },
        };
        value.map(field).transpose()
    }

    fn made_arrays<'py>(&self, py: Python<'py>) -> &Bound<'py, PyDict> {
        let arrays = self.arrays.get_or_init(py, || PyDict::new(py).unbind());
        arrays.bind(py)
    }

    fn array<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        if let Some(arrays) = self.arrays.get(py)
            && let Some(value) = arrays.bind(py).get_item(name)?
        {
            return Ok(Some(value));
        }
        match &self.made {
            Some(made) if made.others().contains(&name) => {
                let value = made.other(py, name)?;
                self.made_arrays(py).set_item(name, &value)?;
                Ok(Some(value))
            }
            _ => Ok(None),
        }
    }

    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyDict>> {
        for name in self.made.iter().flat_map(|made| made.others()) {
            self.array(py, name)?;
        }
        Ok(self.made_arrays(py))
    }
}

#[pymethods]
impl Record {
    #[new]
    #[pyo3(signature = (fields, arrays=None))]
    fn py_new(fields: Bound<'_, PyDict>, arrays: Option<Bound<'_, PyDict>>) -> Self {
        Self::restored(fields, arrays)
    }

    pub(crate) fn __getattr__<'py>(
        slf: &Bound<'py, Self>,
        name: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, own) = (slf.py(), slf.get());
        // `class` is a keyword of Python, so the attribute is `class_`.
        let key = name.strip_suffix('_').unwrap_or(name);
        match own.field(py, key)? {
            Some(value) => Ok(value),
            None => Err(PyAttributeError::new_err(no_field(slf, name)?)),
        }
    }

    /// Value of the field with this name. The name may be a path of a config, such as "scene.sensor.pitch".
    fn __getitem__<'py>(slf: &Bound<'py, Self>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        match slf.get().field(slf.py(), name)? {
            Some(value) => Ok(value),
            None => Err(PyKeyError::new_err(no_field(slf, name)?)),
        }
    }

    fn __dir__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, own) = (slf.py(), slf.get());
        let names = py.get_type::<PyAny>().call_method1("__dir__", (slf,))?;
        names.call_method1("extend", (own.fields(py)?,))?;
        names.call_method1("extend", (own.made_arrays(py),))?;
        let others: Vec<_> = own.made.iter().flat_map(|made| made.others()).collect();
        names.call_method1("extend", (others,))?;
        Ok(PySet::new(py, names.try_iter()?.flatten())?.into_any())
    }

    fn __float__(slf: &Bound<'_, Self>) -> PyResult<f64> {
        slf.getattr("value")?.extract()
    }

    /// The fields as dictionaries, lists, numbers and texts, with the same values as the JSON of the command line.
    ///
    /// With `arrays=True`, the arrays, tables and figures are included.
    #[pyo3(signature = (*, arrays=false))]
    fn to_dict<'py>(slf: &Bound<'py, Self>, arrays: bool) -> PyResult<Bound<'py, PyAny>> {
        let (py, own) = (slf.py(), slf.get());
        let copy = py.import("copy")?.getattr("deepcopy")?;
        let fields = copy.call1((own.fields(py)?,))?;
        if arrays {
            for (name, value) in own.arrays(py)?.iter() {
                let value = match value.cast::<Self>() {
                    Ok(record) => Self::to_dict(record, true)?,
                    Err(_) => copy.call1((value,))?,
                };
                fields.set_item(name, value)?;
            }
        }
        Ok(fields)
    }

    fn __eq__(slf: &Bound<'_, Self>, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let py = slf.py();
        let is_same_kind = slf.get_type().is(other.get_type());
        let Ok(other) = other.cast::<Self>() else {
            return Ok(false);
        };
        let [one, two] = [slf.get(), other.get()];
        // A result without JSON fields is a map, which consists of arrays only. Arrays are not compared, so a map
        // equals only itself.
        if !is_same_kind || one.fields(py)?.is_empty() {
            return Ok(slf.is(other));
        }
        if !one.fields(py)?.eq(two.fields(py)?)? {
            return Ok(false);
        }
        let others = two.arrays(py)?;
        for (name, table) in one.arrays(py)?.iter() {
            if table.is_instance_of::<PyDict>() && !table.eq(others.get_item(name)?)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyType>, Bound<'py, PyTuple>)> {
        let (py, own) = (slf.py(), slf.get());
        let state = PyTuple::new(py, [own.fields(py)?, own.arrays(py)?])?;
        Ok((slf.get_type(), state))
    }

    fn __repr__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py()
            .import("palpate._show")?
            .call_method1("text", (slf,))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py()
            .import("palpate._show")?
            .call_method1("html", (slf,))
    }
}

fn no_field(record: &Bound<'_, Record>, name: &str) -> PyResult<String> {
    let kind = record.get_type().name()?;
    Ok(format!("{kind} has no field {name:?}"))
}

pub(crate) fn records(py: Python<'_>, warnings: &[Warning]) -> PyResult<Py<PyAny>> {
    Ok(field(to_python(py, &warnings)?)?.unbind())
}

/// Converts a Python number to a float, and None to NaN. The result is `None` for any other object.
pub(crate) fn number(item: &Bound<'_, PyAny>) -> Option<f64> {
    let is_number = item.is_instance_of::<PyFloat>() || item.is_instance_of::<PyInt>();
    match is_number && !item.is_instance_of::<PyBool>() {
        true => item.extract().ok(),
        false => item.is_none().then_some(f64::NAN),
    }
}

/// Converts a value to the form in which Python reads it. A dict becomes a record, and a list of numbers becomes a
/// NumPy array. Other lists are converted item by item; other values stay as they are.
fn field(value: Bound<'_, PyAny>) -> PyResult<Bound<'_, PyAny>> {
    let py = value.py();
    if let Ok(table) = value.cast_exact::<PyDict>() {
        return Ok(Bound::new(py, Record::restored(table.clone(), None))?.into_any());
    }
    let Ok(list) = value.cast::<PyList>() else {
        return Ok(value);
    };
    let numbers: Option<Vec<f64>> = list.iter().map(|item| number(&item)).collect();
    if let Some(numbers) = numbers.filter(|numbers| !numbers.is_empty()) {
        return Ok(numpy::PyArray1::from_vec(py, numbers).into_any());
    }
    let items = list.iter().map(field).collect::<PyResult<Vec<_>>>()?;
    Ok(PyList::new(py, items)?.into_any())
}

/// Defines a Python class of results. Python finds the fields after the documentation directly. It finds all other fields
/// by `__getattr__`, which is slower, because Python first raises an exception.
macro_rules! record {
    ($name:ident, $doc:literal $(, $getter:ident)*) => {
        #[doc = $doc]
        #[pyo3::pyclass(extends = $crate::record::Record, frozen, module = "palpate")]
        pub(crate) struct $name;

        impl $name {
            /// Converts a record to an object of this Python class.
            pub(crate) fn of(
                py: pyo3::Python<'_>,
                record: $crate::record::Record,
            ) -> pyo3::PyResult<pyo3::Bound<'_, pyo3::PyAny>> {
                let class = pyo3::PyClassInitializer::from(record).add_subclass(Self);
                Ok(pyo3::Bound::new(py, class)?.into_any())
            }
        }

        #[pyo3::pymethods]
        impl $name {
            #[new]
            #[pyo3(signature = (fields, arrays=None))]
            fn py_new(
                fields: pyo3::Bound<'_, pyo3::types::PyDict>,
                arrays: Option<pyo3::Bound<'_, pyo3::types::PyDict>>,
            ) -> pyo3::PyClassInitializer<Self> {
                let record = $crate::record::Record::restored(fields, arrays);
                pyo3::PyClassInitializer::from(record).add_subclass(Self)
            }

            $(
                #[getter]
                fn $getter<'py>(
                    slf: &pyo3::Bound<'py, Self>,
                ) -> pyo3::PyResult<pyo3::Bound<'py, pyo3::PyAny>> {
                    $crate::record::Record::__getattr__(slf.as_super(), stringify!($getter))
                }
            )*
        }
    };
}

pub(crate) use record;
