//! Reads the settings of readings and estimators from keyword arguments.

use palpate::config::infinite_length::json_number;
use palpate::config::{Accepts, FieldError, LengthUnit, Setting, StudyConfig};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Map, Value as Json};

use crate::error;
use crate::study::Study;

/// Finds the settings among the keyword arguments of a call, and returns a map from their keys to their values.
/// `tables` contains two functions that return the description of a setting from its key: one for settings of the
/// readings, and one for settings of the estimator.
pub(crate) fn given(
    arguments: Option<&Bound<'_, PyDict>>,
    tables: [fn(&str) -> Option<Setting>; 2],
) -> PyResult<Map<String, Json>> {
    let mut given = Map::new();
    for (name, value) in arguments.iter().flat_map(|arguments| arguments.iter()) {
        let name: String = name.extract()?;
        let key = error::key(&name);
        let known = tables.iter().find_map(|table| table(key));
        let Some(known) = known.filter(|_| error::name(key) == name) else {
            let message = format!("got an unexpected keyword argument '{name}'");
            return Err(PyTypeError::new_err(message));
        };
        if !value.is_none() {
            given.insert(known.key, json(&name, &value, &known.accepts)?);
        }
    }
    Ok(given)
}

fn json(name: &str, value: &Bound<'_, PyAny>, accepts: &Accepts) -> PyResult<Json> {
    let typed = |error: PyErr| {
        let why = error.value(value.py());
        PyTypeError::new_err(format!("argument '{name}': {why}"))
    };
    match accepts {
        Accepts::Word(_) => value.extract().map(Json::String).map_err(typed),
        Accepts::Number(range) if range.is_whole => {
            value.extract::<i64>().map(Json::from).map_err(typed)
        }
        Accepts::Number(range) => match value.extract().map_err(typed)? {
            f64::INFINITY if range.may_be_infinite => Ok(json_number(f64::INFINITY)),
            other => number(name, other),
        },
        Accepts::Vector(size) => {
            let components: Vec<f64> = match size {
                2 => value.extract::<[f64; 2]>().map(Vec::from),
                _ => value.extract::<[f64; 3]>().map(Vec::from),
            }
            .map_err(typed)?;
            let components = components.into_iter();
            components.map(|one| number(name, one)).collect()
        }
    }
}

fn number(name: &str, number: f64) -> PyResult<Json> {
    let json = serde_json::Number::from_f64(number).map(Json::Number);
    json.ok_or_else(|| {
        let message = format!("{name} is {number}; it must be finite");
        error::argument(name, &[], Some(number), message)
    })
}

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

/// Returns the options of an estimate that a cell (grid point) of a study states, or `None` without a study. Lengths
/// are converted to `unit`, the unit of the readings. If `unit` is `None`, lengths keep the unit of the study.
pub(crate) fn like<T>(
    study: Option<&Bound<'_, Study>>,
    cell: usize,
    unit: Option<LengthUnit>,
    options: fn(&StudyConfig, LengthUnit) -> Result<T, FieldError>,
) -> PyResult<Option<T>> {
    let Some(study) = study.map(|study| study.get().study()) else {
        return Ok(None);
    };
    let of_cell = study.cell(cell).map_err(error::config)?;
    let unit = unit.unwrap_or(of_cell.config.length_unit);
    let options = options(&of_cell.config, unit);
    options
        .map(Some)
        .map_err(|error| error::config(study.error_at(cell, error)))
}
