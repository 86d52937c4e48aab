//! The cells of a study that a picture of `map.csv` shows.

use super::captions::{self, full_value};
use super::request::Request;
use crate::group::by_key;
use crate::table::same;
use crate::{ReportError, Study};

/// Cells by a row of each, at least one, and what is to be said of the others.
pub(crate) struct Chosen {
    pub(crate) rows: Vec<usize>,
    pub(crate) notes: Vec<String>,
}

/// The cells that pass the filters and are among the `mapped`.
pub(crate) fn choose(of: Request<'_>, mapped: &[u64]) -> Result<Chosen, ReportError> {
    let table = of.study.cells();
    let cells = by_key((0..table.rows()).map(|row| (table.cell(row), row)));
    let mut cells: Vec<usize> = cells.into_iter().map(|(_, rows)| rows[0]).collect();
    let mut absent = Vec::new();
    for (path, values) in of.plot.filters() {
        let axis = of.axis("where", path)?;
        let known = |value: &&String| axis.values().iter().any(|there| same(value, there));
        let lost = values.iter().filter(|value| !known(value));
        absent.extend(lost.map(|value| format!("{path} = {value}")));
        cells.retain(|row| values.iter().any(|value| same(value, axis.text(*row))));
    }
    let (rows, without): (Vec<usize>, Vec<usize>) = cells
        .into_iter()
        .partition(|row| mapped.contains(&table.cell(*row)));
    if rows.is_empty() {
        let lost = captions::lost(&absent);
        return Err(of.bad(format!(
            "`where` leaves no cell that has a map in map.csv{lost}"
        )));
    }
    let mut notes = Vec::new();
    if !without.is_empty() {
        let told = without.iter().take(4).map(|row| place(of.study, *row));
        let told = told.collect::<Vec<_>>().join("; ");
        let more = if without.len() > 4 { "; …" } else { "" };
        notes.push(format!("No map: {told}{more}."));
    }
    notes.extend(captions::absent(&absent));
    Ok(Chosen { rows, notes })
}

/// Words for the place of a row in the sweep.
fn place(study: &Study, row: usize) -> String {
    let values = captions::swept_values(study.cells(), row);
    match values.is_empty() {
        true => "the only cell".to_owned(),
        false => values.join(", "),
    }
}

/// Words for the settings that the cells of some rows share: the object, unless it is swept, and the axes with one
/// value.
pub(crate) fn in_common(study: &Study, rows: &[usize]) -> Vec<String> {
    let axes = study.cells().axes();
    let of_object = |header: &str| header.starts_with("scene.object");
    let is_swept = axes.iter().any(|axis| of_object(&axis.header));
    let object = if is_swept {
        None
    } else {
        captions::object(study)
    };
    let shared = axes
        .iter()
        .filter_map(|axis| match axis.among(rows).as_slice() {
            [value] => Some(full_value(axis, value)),
            _ => None,
        });
    object.into_iter().chain(shared).collect()
}
