//! Order of the panels: the true map first, then the cells it is true of, row by row.

use super::table::CellMap;
use crate::Table;
use crate::group::by_key;
use crate::plot::captions::full_value;
use crate::table::Axis;

/// At most this many cells in a row of panels.
const PER_ROW: usize = 5;
/// Cells in a row if their number is no good guide.
const OTHERWISE: usize = 4;

/// A cell to draw, with a row of `cells.csv` that tells where it stands in the sweep.
#[derive(Clone, Copy)]
pub(crate) struct Shown<'a> {
    pub(crate) map: &'a CellMap,
    pub(crate) row: usize,
}

/// A row of panels.
pub(crate) struct Row<'a> {
    /// Words for the settings that the cells of this row share and those of other rows do not.
    pub(crate) heading: String,
    /// True map, shown first in the row where it differs from that of the rows above.
    pub(crate) truth: Option<&'a CellMap>,
    /// Cells of the row, each with the words that tell it from the others.
    pub(crate) cells: Vec<(String, &'a CellMap)>,
}

/// Rows of panels for `shown` (at least one).
pub(crate) fn rows<'a>(table: &Table, shown: &[Shown<'a>]) -> Vec<Row<'a>> {
    let rows: Vec<usize> = shown.iter().map(|cell| cell.row).collect();
    let varying: Vec<&Axis> = table
        .axes()
        .iter()
        .filter(|axis| axis.among(&rows).len() > 1)
        .collect();
    let across = across(&varying, &rows);
    let down: Vec<&Axis> = varying
        .iter()
        .filter(|axis| across.is_none_or(|across| across.header != axis.header))
        .copied()
        .collect();
    let per_row = across
        .map(|axis| axis.among(&rows).len())
        .filter(|count| *count <= PER_ROW)
        .unwrap_or(OTHERWISE);
    let words = |axes: &[&Axis], row: usize| {
        let values = axes.iter().map(|axis| full_value(axis, axis.text(row)));
        values.collect::<Vec<_>>().join(" · ")
    };

    // One true map stands for all cells of an object.
    let mut axes = table.axes().iter();
    let object = axes.find(|axis| axis.header.starts_with("scene.object"));
    let truth = |cell: &Shown<'a>| (&cell.map.truth, object.map(|axis| axis.text(cell.row)));
    let mut arranged = Vec::new();
    for (_, cells) in by_key(shown.iter().map(|cell| (truth(cell), *cell))) {
        let mut truth = Some(cells[0].map);
        for (heading, cells) in by_key(cells.iter().map(|cell| (words(&down, cell.row), *cell))) {
            for chunk in cells.chunks(per_row) {
                let title = |cell: &Shown<'a>| (words(across.as_slice(), cell.row), cell.map);
                arranged.push(Row {
                    heading: heading.clone(),
                    truth: truth.take(),
                    cells: chunk.iter().map(title).collect(),
                });
            }
        }
    }
    arranged
}

/// The axis whose values stand side by side: of those that fit into a row the one with the most values, the
/// last of several; else the last.
fn across<'a>(varying: &[&'a Axis], rows: &[usize]) -> Option<&'a Axis> {
    let count = |axis: &&&Axis| axis.among(rows).len();
    let fitting = varying.iter().filter(|axis| count(axis) <= PER_ROW);
    fitting.max_by_key(count).or(varying.last()).copied()
}
