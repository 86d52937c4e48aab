//! Converts the arguments of a Python call to a question.

use palpate::AnswerError;
use palpate::config::{Varied, Vary};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString, PyTuple};
use serde_json::Value as Json;

use crate::error;
use crate::json::{from_python, to_toml};

/// Converts the library's error for a question without an answer to a Python exception. `quantity` is the name of the
/// Python argument that states the quantity; the exception names this argument if the quantity is wrong.
pub(super) fn unanswered(error: AnswerError, quantity: &str) -> PyErr {
    let message = error.to_string();
    let (argument, value) = match error {
        AnswerError::Config(error) => return error::config(error),
        AnswerError::Undefined { .. } => return error::RunError::new_err(message),
        AnswerError::OutOfRange { setting, value, .. } => (setting, Some(value)),
        AnswerError::NoQuantity { .. } => (quantity, None),
        AnswerError::NoError(_) | AnswerError::Twice(_) | AnswerError::TooManyCells(_) => {
            ("set", None)
        }
        _ => ("vary", None),
    };
    error::argument(argument, &[], value, message)
}

pub(super) fn wrong(message: impl std::fmt::Display) -> PyErr {
    error::argument("vary", &[], None, format!("vary: {message}"))
}

/// Converts the argument `vary` to a list of fields, each with the values to try. The argument is a dictionary, or one
/// or several texts such as "scene.sensor.pitch=0.05..2".
pub(super) fn varied(vary: &Bound<'_, PyAny>) -> PyResult<Vec<Vary>> {
    let text = |text: &Bound<'_, PyString>| text.to_cow()?.parse::<Vary>().map_err(wrong);
    if let Ok(one) = vary.cast::<PyString>() {
        return Ok(vec![text(one)?]);
    }
    if let Ok(fields) = vary.cast::<PyDict>().map(|fields| fields.iter())
        && fields.len() > 0
    {
        return fields
            .map(|(path, values)| {
                let path: String = path.extract()?;
                let values = values_of(&path, &values)?;
                Ok(Vary { path, values })
            })
            .collect();
    }
    match vary.cast::<PyList>() {
        Ok(texts)
            if !texts.is_empty() && texts.iter().all(|one| one.is_instance_of::<PyString>()) =>
        {
            texts.iter().map(|one| text(one.cast()?)).collect()
        }
        _ => Err(wrong(
            "must be a text such as \"scene.sensor.pitch=0.05..2\", a list of such texts, or a dictionary of paths with a \
             tuple (from, to) or a list of values each",
        )),
    }
}

/// Converts the values of a varied field to a range or a list. A tuple of two numbers is a range; a list contains
/// single values.
fn values_of(path: &str, values: &Bound<'_, PyAny>) -> PyResult<Varied> {
    if let Ok(range) = values.cast::<PyTuple>() {
        let (from, to): (f64, f64) = range
            .extract()
            .map_err(|_| wrong(format!("{path}: a range must be a tuple of two numbers")))?;
        if !(from.is_finite() && to.is_finite() && from <= to) {
            let message =
                format!("{path}: the range {from} to {to} must be finite and run upwards");
            return Err(wrong(message));
        }
        return Ok(Varied::Range { from, to });
    }
    match listed(path, values)? {
        Some(values) if !values.is_empty() => Ok(Varied::Listed(values)),
        _ => Err(wrong(format!(
            "{path}: values must be a tuple (from, to) or a list"
        ))),
    }
}

/// Converts a Python list to TOML values; `None` for an object that is not a list.
pub(super) fn listed(path: &str, values: &Bound<'_, PyAny>) -> PyResult<Option<Vec<toml::Value>>> {
    let Json::Array(values) = from_python(values)? else {
        return Ok(None);
    };
    let values = values.iter().map(|value| to_toml(path, value));
    values.collect::<PyResult<_>>().map(Some)
}

pub(super) fn set(set: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<(String, toml::Value)>> {
    let fields = set.into_iter().flat_map(|fields| fields.iter());
    let field = |(path, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let path: String = path.extract()?;
        let value = to_toml(&path, &from_python(&value)?)?;
        Ok((path, value))
    };
    fields.map(field).collect()
}
