//! The cells of a study that a picture of `map.csv` shows.

use super::captions::{self, full_value};
use super::select::{present, same};
use super::spec::{Heading, nearest};
use crate::{ReportError, Study};

/// Cells by a row of each, at least one, and what is to be said of the others.
pub(crate) struct Chosen {
    pub(crate) rows: Vec<usize>,
    pub(crate) notes: Vec<String>,
}

/// The cells that pass the filters and are among the `mapped`.
pub(crate) fn choose(
    study: &Study,
    heading: &Heading,
    filters: &[(String, Vec<String>)],
    mapped: &[u64],
) -> Result<Chosen, ReportError> {
    let table = study.cells();
    let mut cells: Vec<usize> = Vec::new();
    for row in 0..table.rows() {
        if !cells
            .iter()
            .any(|known| table.cell(*known) == table.cell(row))
        {
            cells.push(row);
        }
    }
    let mut absent = Vec::new();
    for (path, values) in filters {
        let axis = table.axis(path).ok_or_else(|| ReportError::UnknownColumn {
            path: study.run_toml(),
            plot: heading.name.clone(),
            key: "where".to_owned(),
            value: path.clone(),
            known: nearest(path, table.axes().iter().map(|axis| axis.header.as_str())),
        })?;
        let known = |value: &&String| axis.values().iter().any(|there| same(value, there));
        absent.extend(
            values
                .iter()
                .filter(|value| !known(value))
                .map(|value| format!("{path} = {value}")),
        );
        cells.retain(|row| values.iter().any(|value| same(value, axis.text(*row))));
    }
    let (rows, without): (Vec<usize>, Vec<usize>) = cells
        .into_iter()
        .partition(|row| mapped.contains(&table.cell(*row)));
    if rows.is_empty() {
        let lost: String = absent
            .iter()
            .map(|lost| format!("; the table has no {lost}"))
            .collect();
        return Err(ReportError::BadPlot {
            path: study.run_toml(),
            plot: heading.name.clone(),
            problem: format!("`where` leaves no cell that has a map in map.csv{lost}"),
        });
    }
    let mut notes = Vec::new();
    if !without.is_empty() {
        let told: Vec<String> = without
            .iter()
            .take(4)
            .map(|row| place(study, *row))
            .collect();
        let more = if without.len() > told.len() {
            "; …"
        } else {
            ""
        };
        notes.push(format!("No map: {}{more}.", told.join("; ")));
    }
    if !absent.is_empty() {
        notes.push(format!("Not in the table: {}.", absent.join(", ")));
    }
    Ok(Chosen { rows, notes })
}

/// Words for the place of a row in the sweep.
fn place(study: &Study, row: usize) -> String {
    let axes = study.cells().axes().iter();
    let values: Vec<String> = axes.map(|axis| full_value(axis, axis.text(row))).collect();
    if values.is_empty() {
        "the only cell".to_owned()
    } else {
        values.join(", ")
    }
}

/// Words for the settings that the cells of some rows share: the object, unless it is swept, and the axes with one
/// value.
pub(crate) fn in_common(study: &Study, rows: &[usize]) -> Vec<String> {
    let axes = study.cells().axes();
    let is_swept = axes
        .iter()
        .any(|axis| axis.header.starts_with("scene.object"));
    let object = if is_swept {
        None
    } else {
        captions::object(study)
    };
    let mut parts: Vec<String> = object.into_iter().collect();
    for axis in axes {
        if let [value] = present(axis, rows).as_slice() {
            parts.push(full_value(axis, value));
        }
    }
    parts
}
