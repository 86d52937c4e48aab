//! Defines the exceptions of the package, and converts the library's errors to exceptions.

use std::fmt::Display;

use palpate::ConfigError as BadConfig;
use palpate::config::{SettingError, rename_settings};
use palpate::recorded::RecordedError;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

create_exception!(
    palpate,
    PalpateError,
    PyValueError,
    "Error of palpate, a ValueError.\n\n`argument` is the name of the wrong argument, or None;\n\
     `index` is the position of the wrong value in it, counted from 0;\n\
     `value` is the wrong value if it is a number, or None."
);
create_exception!(
    palpate,
    ArgumentError,
    PalpateError,
    "Invalid argument: a wrong shape, a number that is not finite, or a setting that is out of its range or has no\n\
     effect together with the other settings."
);
create_exception!(
    palpate,
    ReadingsError,
    PalpateError,
    "The readings do not determine a curvature; the message states the reason."
);
create_exception!(
    palpate,
    ConfigError,
    PalpateError,
    "Invalid config of a study. `path` is the path of the wrong field: keys joined by dots."
);
create_exception!(
    palpate,
    RunError,
    PalpateError,
    "The work on a study failed; the message states the reason."
);

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    let base = py.get_type::<PalpateError>();
    base.setattr("argument", py.None())?;
    base.setattr("index", PyTuple::empty(py))?;
    base.setattr("value", py.None())?;
    let config = py.get_type::<ConfigError>();
    config.setattr("path", "")?;
    module.add("PalpateError", base)?;
    module.add("ArgumentError", py.get_type::<ArgumentError>())?;
    module.add("ReadingsError", py.get_type::<ReadingsError>())?;
    module.add("ConfigError", config)?;
    module.add("RunError", py.get_type::<RunError>())
}

/// Exception for the wrong argument `name`. `value` is the wrong number; `index` is its position if the argument is an
/// array.
pub(crate) fn argument(
    name: &str,
    index: &[usize],
    value: Option<f64>,
    message: impl Into<String>,
) -> PyErr {
    let error = ArgumentError::new_err(message.into());
    // Ignore errors: the exception has a dictionary for its attributes, so setting an attribute cannot fail.
    let _ = Python::attach(|py| {
        let own = error.value(py);
        own.setattr("argument", name)?;
        own.setattr("index", PyTuple::new(py, index)?)?;
        own.setattr("value", value)
    });
    error
}

/// Exception for an argument of the wrong shape, for example `points: must have shape (n, 3), has (30, 2)`.
pub(crate) fn shape(name: &str, wanted: &str, found: &[usize]) -> PyErr {
    let found: Vec<String> = found.iter().map(usize::to_string).collect();
    let found = match found.as_slice() {
        [one] => format!("({one},)"),
        all => format!("({})", all.join(", ")),
    };
    let message = format!("{name}: must have shape {wanted}, has {found}");
    argument(name, &[], None, message)
}

/// Settings whose names in the config and in Python differ. Each pair consists of the config key and the name of the
/// Python argument.
const RENAMED: [(&str, &str); 3] = [
    ("kind", "method"),
    ("from", "source"),
    ("normals", "tangent_normals"),
];

pub(crate) fn key(argument: &str) -> &str {
    let renamed = RENAMED.iter().find(|(_, name)| *name == argument);
    renamed.map_or(argument, |(key, _)| key)
}

pub(crate) fn name(key: &str) -> &str {
    let renamed = RENAMED.iter().find(|(renamed, _)| *renamed == key);
    renamed.map_or(key, |(_, name)| name)
}

/// Message of a library error. The config keys of settings in the message are replaced by the names of the Python
/// arguments.
pub(crate) fn text(error: &impl Display) -> String {
    rename_settings(&error.to_string(), |key| name(key).to_owned())
}

pub(crate) fn recorded(error: RecordedError) -> PyErr {
    let message = text(&error);
    match error {
        RecordedError::Array {
            array,
            index,
            value,
            ..
        } => argument(array, &index, value, message),
        _ => ReadingsError::new_err(message),
    }
}

pub(crate) fn run(error: impl Display) -> PyErr {
    RunError::new_err(error.to_string())
}

pub(crate) fn setting(error: SettingError) -> PyErr {
    argument(name(&error.key), &[], error.value, text(&error))
}

pub(crate) fn config(error: BadConfig) -> PyErr {
    let raised = ConfigError::new_err(error.to_string());
    let _ = Python::attach(|py| raised.value(py).setattr("path", error.path));
    raised
}
