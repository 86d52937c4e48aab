//! Maps of the classes of shape, as small multiples: the true map, then that of each cell.

mod arrange;
mod draw;
mod layout;
mod squares;
mod table;

use super::captions::{self, full_value};
use super::select::{present, same};
use super::spec::{MapSpec, nearest};
use crate::{ReportError, Study, words};
use arrange::Shown;
use table::{MapProblem, Maps};

pub(crate) use draw::draw;
pub(crate) use layout::Layout;

/// More panels than this are no picture.
const MOST_CELLS: usize = 60;

/// Draws what `spec` asks for of the study's `map.csv`.
pub(crate) fn layout(study: &Study, spec: &MapSpec) -> Result<Layout, ReportError> {
    let maps = table::read(&study.dir().join("map.csv")).map_err(|problem| match problem {
        MapProblem::File(error) => error,
        MapProblem::Points(problem) => bad(study, spec, problem),
    })?;
    let Chosen { shown, notes } = choose(study, spec, &maps)?;
    let title = spec.heading.title.as_deref().unwrap_or(study.title());
    let rows = arrange::rows(study.cells(), &shown);
    Ok(Layout::of(
        &Words {
            name: &spec.heading.name,
            title,
            subtitle: subtitle(study, &shown),
            notes,
            unit: words::unit(&maps.unit),
        },
        &rows,
    ))
}

/// The texts around the panels.
pub(crate) struct Words<'a> {
    name: &'a str,
    title: &'a str,
    subtitle: String,
    notes: Vec<String>,
    /// Unit of x and y as shown.
    unit: String,
}

struct Chosen<'a> {
    shown: Vec<Shown<'a>>,
    notes: Vec<String>,
}

/// The cells that pass the filters and have a map, and what is to be said of the others.
fn choose<'a>(study: &Study, spec: &MapSpec, maps: &'a Maps) -> Result<Chosen<'a>, ReportError> {
    let table = study.cells();
    let mut rows: Vec<usize> = Vec::new();
    for row in 0..table.rows() {
        if !rows
            .iter()
            .any(|known| table.cell(*known) == table.cell(row))
        {
            rows.push(row);
        }
    }
    let mut absent = Vec::new();
    for (path, values) in &spec.filters {
        let axis = table.axis(path).ok_or_else(|| ReportError::UnknownColumn {
            path: study.run_toml(),
            plot: spec.heading.name.clone(),
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
        rows.retain(|row| values.iter().any(|value| same(value, axis.text(*row))));
    }
    let (mut shown, mut without) = (Vec::new(), Vec::new());
    for row in rows {
        match maps.cells.iter().find(|map| map.cell == table.cell(row)) {
            Some(map) => shown.push(Shown { map, row }),
            None => without.push(row),
        }
    }
    if shown.is_empty() {
        let lost: String = absent
            .iter()
            .map(|lost| format!("; the table has no {lost}"))
            .collect();
        let problem = format!("`where` leaves no cell that has a map in map.csv{lost}");
        return Err(bad(study, spec, problem));
    }
    if shown.len() > MOST_CELLS {
        return Err(bad(
            study,
            spec,
            format!(
                "{} maps are no picture; choose at most {MOST_CELLS} by `where`",
                shown.len()
            ),
        ));
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
    Ok(Chosen { shown, notes })
}

fn bad(study: &Study, spec: &MapSpec, problem: String) -> ReportError {
    ReportError::BadPlot {
        path: study.run_toml(),
        plot: spec.heading.name.clone(),
        problem,
    }
}

/// Where a row stands in the sweep.
fn place(study: &Study, row: usize) -> String {
    let axes = study.cells().axes().iter();
    let values: Vec<String> = axes.map(|axis| full_value(axis, axis.text(row))).collect();
    if values.is_empty() {
        "the only cell".to_owned()
    } else {
        values.join(", ")
    }
}

/// What all panels have in common.
fn subtitle(study: &Study, shown: &[Shown<'_>]) -> String {
    let rows: Vec<usize> = shown.iter().map(|cell| cell.row).collect();
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
        if let [value] = present(axis, &rows).as_slice() {
            parts.push(full_value(axis, value));
        }
    }
    let mut sides: Vec<usize> = shown.iter().map(|cell| cell.map.side).collect();
    sides.sort_unstable();
    sides.dedup();
    if let [side] = sides.as_slice() {
        parts.push(format!("{side} × {side} points"));
    }
    parts.push("one trial per panel".to_owned());
    parts.join(" · ")
}
