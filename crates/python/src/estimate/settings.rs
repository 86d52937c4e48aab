//! Settings of estimators by their keys in a config.

use palpate::config::LengthUnit;
use pyo3::prelude::*;
use serde_json::{Map, Value as Json};

use crate::error;

/// Settings that were given, by their keys.
pub(crate) fn given<const N: usize>(settings: [(&str, Option<Json>); N]) -> Map<String, Json> {
    let given = settings
        .into_iter()
        .filter_map(|(key, value)| Some((key.to_owned(), value?)));
    given.collect()
}

/// Number of a setting, as JSON; one that is not finite is none that a setting may have.
pub(crate) fn number(key: &str, value: Option<f64>) -> PyResult<Option<Json>> {
    let Some(number) = value else {
        return Ok(None);
    };
    match serde_json::Number::from_f64(number) {
        Some(number) => Ok(Some(Json::Number(number))),
        None => {
            let message = format!("{key} is {number}; it must be finite");
            Err(error::argument(key, &[], Some(number), message))
        }
    }
}

/// Word of a setting.
pub(crate) fn word(value: Option<String>) -> Option<Json> {
    value.map(Json::String)
}

/// Unit of lengths.
pub(crate) fn length_unit(name: Option<&str>) -> PyResult<Option<LengthUnit>> {
    let unit = |name: &str| {
        let unit = serde_json::from_value(Json::String(name.to_owned()));
        unit.map_err(|_| {
            let message = format!("length_unit: must be one of m, cm, mm, um, unit, is {name:?}");
            error::argument("length_unit", &[], None, message)
        })
    };
    name.map(unit).transpose()
}
