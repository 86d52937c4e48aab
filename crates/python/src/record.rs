//! Results with named fields.

use palpate::Warning;
use pyo3::exceptions::{PyAttributeError, PyKeyError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyFloat, PyInt, PyList, PyTuple, PyType};
use serde::Serialize;

use crate::json::to_python;

/// Source that a result is made from: its fields are not made before they are asked for.
pub(crate) trait Made: Send + Sync {
    /// Fields as plain values: what the command line prints as JSON.
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>>;

    /// Names of the fields beside them: arrays, tables, figures.
    fn others(&self) -> &'static [&'static str] {
        &[]
    }

    /// One of the fields beside them, by its name.
    fn other<'py>(&self, _: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        Err(PyAttributeError::new_err(name.to_owned()))
    }
}

/// Result with named fields.
///
/// A field that is a table is a `Record` itself, one that is a list of numbers an array of float64, in which NaN stands for
/// none. `float(record)` is its `value`; `record["name"]` is the field of any name.
#[pyclass(subclass, frozen, module = "palpate")]
pub(crate) struct Record {
    made: Option<Box<dyn Made>>,
    fields: PyOnceLock<Py<PyDict>>,
    arrays: PyOnceLock<Py<PyDict>>,
}

impl Record {
    pub(crate) fn new(made: impl Made + 'static) -> Self {
        Self {
            made: Some(Box::new(made)),
            fields: PyOnceLock::new(),
            arrays: PyOnceLock::new(),
        }
    }

    pub(crate) fn restored(fields: Bound<'_, PyDict>, arrays: Option<Bound<'_, PyDict>>) -> Self {
        let py = fields.py();
        let arrays = arrays.unwrap_or_else(|| PyDict::new(py));
        let known = |dict: Bound<'_, PyDict>| {
            let lock = PyOnceLock::new();
            lock.get_or_init(py, || dict.unbind());
            lock
        };
        Self {
            made: None,
            fields: known(fields),
            arrays: known(arrays),
        }
    }

    /// Record of a value that serialises.
    pub(crate) fn of(py: Python<'_>, value: &impl Serialize) -> PyResult<Self> {
        let fields = to_python(py, value)?.cast_into::<PyDict>()?;
        Ok(Self::restored(fields, None))
    }

    fn fields<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyDict>> {
        let fields = self.fields.get_or_try_init(py, || match &self.made {
            Some(made) => Ok(made.fields(py)?.cast_into::<PyDict>()?.unbind()),
            None => Ok::<_, PyErr>(PyDict::new(py).unbind()),
        })?;
        Ok(fields.bind(py))
    }

    /// A field of either kind, as it is handed out.
    fn field<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        // Those beside the plain ones first, for which these need not be made.
        let value = match self.array(py, name)? {
            Some(value) => Some(value),
            None => self.fields(py)?.get_item(name)?,
        };
        value.map(field).transpose()
    }

    /// Fields beside the plain ones, as far as they were made.
    fn made_arrays<'py>(&self, py: Python<'py>) -> &Bound<'py, PyDict> {
        let arrays = self.arrays.get_or_init(py, || PyDict::new(py).unbind());
        arrays.bind(py)
    }

    /// A field beside the plain ones, made where it was not.
    fn array<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let arrays = self.made_arrays(py);
        if let Some(value) = arrays.get_item(name)? {
            return Ok(Some(value));
        }
        let Some(made) = self
            .made
            .as_ref()
            .filter(|made| made.others().contains(&name))
        else {
            return Ok(None);
        };
        let value = made.other(py, name)?;
        arrays.set_item(name, &value)?;
        Ok(Some(value))
    }

    /// All fields beside the plain ones.
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

    fn __getattr__<'py>(slf: &Bound<'py, Self>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let (py, own) = (slf.py(), slf.get());
        // A word of the language, such as `class_`.
        let key = name.strip_suffix('_').unwrap_or(name);
        match own.field(py, key)? {
            Some(value) => Ok(value),
            None => Err(PyAttributeError::new_err(no_field(slf, name)?)),
        }
    }

    /// Field by its name, also where that is no word of Python: the path of a config's field.
    fn __getitem__<'py>(slf: &Bound<'py, Self>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        match slf.get().field(slf.py(), name)? {
            Some(value) => Ok(value),
            None => Err(PyKeyError::new_err(no_field(slf, name)?)),
        }
    }

    fn __dir__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyList>> {
        let (py, own) = (slf.py(), slf.get());
        let of_class = slf.get_type().call_method0("mro")?;
        let names = PyList::empty(py);
        for class in of_class.try_iter()? {
            names.call_method1("extend", (class?.getattr("__dict__")?,))?;
        }
        names.call_method1("extend", (own.fields(py)?,))?;
        names.call_method1("extend", (own.made_arrays(py),))?;
        for name in own.made.iter().flat_map(|made| made.others()) {
            names.append(name)?;
        }
        Ok(names)
    }

    fn __float__(slf: &Bound<'_, Self>) -> PyResult<f64> {
        slf.getattr("value")?.extract()
    }

    /// Fields as dictionaries, lists, numbers and texts: what `palpate estimate` prints as JSON.
    ///
    /// With `arrays=True` also those that are arrays, as such.
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
        match other.cast::<Self>() {
            // Arrays alone, as of a map, tell whether they are equal only one by one.
            Ok(other) if is_same_kind && !slf.get().fields(py)?.is_empty() => {
                slf.get().fields(py)?.eq(other.get().fields(py)?)
            }
            Ok(other) => Ok(slf.is(other)),
            _ => Ok(false),
        }
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

/// Warnings as a list of records.
pub(crate) fn records(py: Python<'_>, warnings: &[Warning]) -> PyResult<Py<PyAny>> {
    Ok(field(to_python(py, &warnings)?)?.unbind())
}

/// Field as it is handed out.
fn field(value: Bound<'_, PyAny>) -> PyResult<Bound<'_, PyAny>> {
    let py = value.py();
    if let Ok(table) = value.cast_exact::<PyDict>() {
        return Ok(Bound::new(py, Record::restored(table.clone(), None))?.into_any());
    }
    let Ok(list) = value.cast::<PyList>() else {
        return Ok(value);
    };
    let is_number = |item: &Bound<'_, PyAny>| {
        item.is_none() || item.is_instance_of::<PyFloat>() || item.is_instance_of::<PyInt>()
    };
    if !list.is_empty() && list.iter().all(|item| is_number(&item)) {
        let number = |item: Bound<'_, PyAny>| match item.is_none() {
            true => Ok(f64::NAN),
            false => item.extract(),
        };
        let numbers: Vec<f64> = list.iter().map(number).collect::<PyResult<_>>()?;
        return Ok(numpy::PyArray1::from_vec(py, numbers).into_any());
    }
    let handed = PyList::empty(py);
    for item in list.iter() {
        handed.append(field(item)?)?;
    }
    Ok(handed.into_any())
}

/// Declares a class of results.
macro_rules! record {
    ($name:ident, $doc:literal) => {
        #[doc = $doc]
        #[pyo3::pyclass(extends = $crate::record::Record, frozen, module = "palpate")]
        pub(crate) struct $name;

        impl $name {
            /// Result that is made from this.
            pub(crate) fn of<'py>(
                py: pyo3::Python<'py>,
                made: impl $crate::record::Made + 'static,
            ) -> pyo3::PyResult<pyo3::Bound<'py, pyo3::PyAny>> {
                let record = $crate::record::Record::new(made);
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
        }
    };
}

pub(crate) use record;
