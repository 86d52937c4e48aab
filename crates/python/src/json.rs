//! JSON as Python's own values, and back.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use serde::Serialize;
use serde_json::{Map, Number, Value as Json};

use crate::error;

/// JSON as TOML; `path` is the field that it is of.
pub(crate) fn to_toml(path: &str, json: &Json) -> PyResult<toml::Value> {
    toml::Value::try_from(json).map_err(|error| {
        let message = format!("{path}: no value of a config: {json}: {error}");
        PyTypeError::new_err(message)
    })
}

/// Value that serialises, as dictionaries, lists, numbers and texts.
pub(crate) fn to_python<'py>(
    py: Python<'py>,
    value: &impl Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    // As text, which keeps the order of the fields.
    let text = serde_json::to_string(value);
    let text = text.map_err(|error| error::RunError::new_err(error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

/// JSON as Python's own value.
pub(crate) fn of_json<'py>(py: Python<'py>, json: &Json) -> PyResult<Bound<'py, PyAny>> {
    Ok(match json {
        Json::Null => py.None().into_bound(py),
        Json::Bool(value) => PyBool::new(py, *value).to_owned().into_any(),
        Json::Number(number) => match (number.as_u64(), number.as_i64()) {
            (Some(whole), _) => whole.into_pyobject(py)?.into_any(),
            (None, Some(whole)) => whole.into_pyobject(py)?.into_any(),
            // Zero without a sign.
            (None, None) => PyFloat::new(py, number.as_f64().unwrap_or(f64::NAN) + 0.0).into_any(),
        },
        Json::String(text) => PyString::new(py, text).into_any(),
        Json::Array(items) => {
            let list = PyList::empty(py);
            items
                .iter()
                .try_for_each(|item| list.append(of_json(py, item)?))?;
            list.into_any()
        }
        Json::Object(table) => {
            let dict = PyDict::new(py);
            table
                .iter()
                .try_for_each(|(key, value)| dict.set_item(key, of_json(py, value)?))?;
            dict.into_any()
        }
    })
}

/// Python's value as JSON: texts, numbers, lists, dictionaries, and what has `tolist`, such as NumPy's arrays and numbers.
pub(crate) fn from_python(value: &Bound<'_, PyAny>) -> PyResult<Json> {
    if value.is_none() {
        return Ok(Json::Null);
    }
    if let Ok(value) = value.cast::<PyBool>() {
        return Ok(Json::Bool(value.is_true()));
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(Json::Number(match value.extract::<i64>() {
            Ok(whole) => whole.into(),
            Err(_) => value.extract::<u64>()?.into(),
        }));
    }
    if let Ok(value) = value.cast::<PyFloat>() {
        let number = value.extract::<f64>()?;
        let refused = || PyTypeError::new_err(format!("a config has no number {number}"));
        return Number::from_f64(number)
            .map(Json::Number)
            .ok_or_else(refused);
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Json::String(text.to_cow()?.into_owned()));
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        let mut table = Map::new();
        for (key, value) in dict.iter() {
            table.insert(key.extract::<String>()?, from_python(&value)?);
        }
        return Ok(Json::Object(table));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.map(|item| from_python(&item?));
        return Ok(Json::Array(items.collect::<PyResult<_>>()?));
    }
    match value.getattr("tolist") {
        Ok(list) => from_python(&list.call0()?),
        Err(_) => {
            let kind = value.get_type().name()?;
            let message = format!("a config has no value of type {kind}: {value}");
            Err(PyTypeError::new_err(message))
        }
    }
}
