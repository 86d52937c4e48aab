//! Presses in a table: what the config says of each, and what was found.

use super::evidence::near;
use crate::{Study, study};

/// The table of the config that holds at `path` for `row`: where a sweep puts labelled tables there the one of the
/// row's label, else the scene's own.
pub(super) fn settings<'a>(study: &'a Study, row: usize, path: &str) -> Option<&'a toml::Table> {
    let Some(axis) = study.cells().axis(path) else {
        return study.setting(path)?.as_table();
    };
    let sweeps = study.config().get("sweep").and_then(toml::Value::as_array);
    sweeps
        .into_iter()
        .flatten()
        .flat_map(|sweep| swept(sweep, path))
        .filter_map(toml::Value::as_table)
        .find(|table| table.get("label").and_then(toml::Value::as_str) == Some(axis.text(row)))
}

/// The values that a sweep puts at `path`, alone or together with other paths.
fn swept<'a>(sweep: &'a toml::Value, path: &str) -> Vec<&'a toml::Value> {
    let values = sweep.get("values").and_then(toml::Value::as_array);
    let values = values.into_iter().flatten();
    if sweep.get("path").and_then(toml::Value::as_str) == Some(path) {
        return values.collect();
    }
    let paths = sweep.get("paths").and_then(toml::Value::as_array);
    let place = paths.and_then(|paths| paths.iter().position(|known| known.as_str() == Some(path)));
    place.map_or(Vec::new(), |place| {
        values
            .filter_map(|row| row.as_array()?.get(place))
            .collect()
    })
}

/// `kind` of the setting at `path` that holds for `row`.
pub(super) fn kind<'a>(study: &'a Study, row: usize, path: &str) -> Option<&'a str> {
    word(study, row, path, "kind")
}

/// The text `key` of what stands at `path` for `row`.
pub(super) fn word<'a>(study: &'a Study, row: usize, path: &str, key: &str) -> Option<&'a str> {
    match study.cells().axis(&format!("{path}.{key}")) {
        Some(axis) => Some(axis.text(row)),
        None => settings(study, row, path)?.get(key)?.as_str(),
    }
}

/// Number under `key` in the setting at `path` that holds for `row`.
pub(super) fn number(study: &Study, row: usize, path: &str, key: &str) -> Option<f64> {
    match study.cells().axis(&format!("{path}.{key}")) {
        Some(axis) => axis.number(row),
        None => study::number(settings(study, row, path)?.get(key)?),
    }
}

/// Word for the setting at `path` that holds for `row`: its label in the table, or its kind.
pub(super) fn label<'a>(study: &'a Study, row: usize, path: &str) -> Option<&'a str> {
    study.text(row, path).or_else(|| kind(study, row, path))
}

/// Rows of `quantity` in the order of the table.
pub(super) fn rows_of(study: &Study, quantity: &str) -> Vec<usize> {
    let table = study.cells();
    let rows = 0..table.rows();
    rows.filter(|row| table.quantity(*row) == quantity)
        .collect()
}

/// The study's unit of length in millimetres; none if it has no name.
pub(super) fn millimetres(study: &Study) -> Option<f64> {
    match study.setting("length_unit")?.as_str()? {
        "m" => Some(1000.0),
        "cm" => Some(10.0),
        "mm" => Some(1.0),
        "um" => Some(0.001),
        _ => None,
    }
}

/// The one of `rows` whose indentation is `indentation`, or what is wrong.
pub(super) fn at_indentation(
    study: &Study,
    rows: &[usize],
    indentation: f64,
) -> Result<usize, String> {
    let there = |row: &usize| {
        let found = study.number(*row, "scene.motion.indentation");
        found.is_some_and(|found| near(found, indentation))
    };
    match rows.iter().copied().filter(there).collect::<Vec<_>>()[..] {
        [row] => Ok(row),
        [] => Err(format!("the table has no indentation of {indentation}")),
        _ => Err(format!(
            "the table has several rows of indentation {indentation}"
        )),
    }
}
