//! Converts JSON to Python's built-in types, and back.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use serde_json::Value as Json;

use crate::error;

pub(crate) fn to_toml(path: &str, json: &Json) -> PyResult<toml::Value> {
    toml::Value::try_from(json).map_err(|error| {
        let message = format!("{path}: a config cannot contain the value {json}: {error}");
        PyTypeError::new_err(message)
    })
}

pub(crate) fn to_python<'py>(
    py: Python<'py>,
    value: &impl Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    // Convert the value to text first, because the text keeps the order of the fields.
    let text = serde_json::to_string(value);
    let text = text.map_err(error::run)?;
    py.import("json")?.call_method1("loads", (text,))
}

/// Converts a Python value to JSON. The value is a text, a number, a list, a dictionary, or an object with the method
/// `tolist`, such as a NumPy array.
pub(crate) fn from_python(value: &Bound<'_, PyAny>) -> PyResult<Json> {
    let py = value.py();
    let settings = PyDict::new(py);
    settings.set_item("allow_nan", false)?;
    let to_list = py
        .import("operator")?
        .call_method1("methodcaller", ("tolist",))?;
    settings.set_item("default", to_list)?;
    let refused = |why: &dyn std::fmt::Display| {
        PyTypeError::new_err(format!("a config cannot have the value {value}: {why}"))
    };
    let text = py
        .import("json")?
        .call_method("dumps", (value,), Some(&settings));
    let text: String = text.map_err(|error| refused(&error.value(py)))?.extract()?;
    serde_json::from_str(&text).map_err(|error| refused(&error))
}
