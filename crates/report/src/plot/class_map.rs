//! Maps of the classes of shape, as small multiples: the true map, then that of each cell.

mod arrange;
mod draw;
mod layout;
mod squares;
mod table;

use super::cells::{self, Chosen};
use super::spec::MapSpec;
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
    let mapped: Vec<u64> = maps.cells.iter().map(|map| map.cell).collect();
    let Chosen { rows, notes } = cells::choose(study, &spec.heading, &spec.filters, &mapped)?;
    if rows.len() > MOST_CELLS {
        let count = rows.len();
        let problem =
            format!("{count} maps are no picture; choose at most {MOST_CELLS} by `where`");
        return Err(bad(study, spec, problem));
    }
    let shown = shown(study, &rows, &maps);
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

/// The maps of the chosen cells, each with a row of its cell.
fn shown<'a>(study: &Study, rows: &[usize], maps: &'a Maps) -> Vec<Shown<'a>> {
    let shown = rows.iter().filter_map(|&row| {
        let cell = study.cells().cell(row);
        let map = maps.cells.iter().find(|map| map.cell == cell)?;
        Some(Shown { map, row })
    });
    shown.collect()
}

fn bad(study: &Study, spec: &MapSpec, problem: String) -> ReportError {
    ReportError::BadPlot {
        path: study.run_toml(),
        plot: spec.heading.name.clone(),
        problem,
    }
}

/// Subtitle of the maps: the settings that all panels share.
fn subtitle(study: &Study, shown: &[Shown<'_>]) -> String {
    let rows: Vec<usize> = shown.iter().map(|cell| cell.row).collect();
    let mut parts = cells::in_common(study, &rows);
    let mut sides: Vec<usize> = shown.iter().map(|cell| cell.map.side).collect();
    sides.sort_unstable();
    sides.dedup();
    if let [side] = sides.as_slice() {
        parts.push(format!("{side} × {side} points"));
    }
    parts.push("one trial per panel".to_owned());
    parts.join(" · ")
}
