//! Which panels stand where: the true map first, then the cells it is true of, row by row.

use super::table::CellMap;
use crate::Table;
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

/// Cells of one true map, by what runs down.
struct Group<'a> {
    first: Shown<'a>,
    lines: Vec<(String, Vec<Shown<'a>>)>,
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

    let mut groups: Vec<Group<'a>> = Vec::new();
    for &cell in shown {
        let at = groups
            .iter()
            .position(|group| of_one_object(table, &group.first, &cell))
            .unwrap_or_else(|| {
                groups.push(Group {
                    first: cell,
                    lines: Vec::new(),
                });
                groups.len() - 1
            });
        let lines = &mut groups[at].lines;
        let heading = words(&down, cell.row);
        match lines.iter_mut().find(|(known, _)| *known == heading) {
            Some((_, cells)) => cells.push(cell),
            None => lines.push((heading, vec![cell])),
        }
    }
    let mut arranged = Vec::new();
    for Group { first, lines } in groups {
        let mut truth = Some(first.map);
        for (heading, cells) in lines {
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

/// Whether one true map stands for both cells.
fn of_one_object(table: &Table, a: &Shown<'_>, b: &Shown<'_>) -> bool {
    let mut axes = table.axes().iter();
    let object = axes.find(|axis| axis.header.starts_with("scene.object"));
    a.map.truth == b.map.truth && object.is_none_or(|axis| axis.text(a.row) == axis.text(b.row))
}

/// The axis whose values stand side by side: of those that fit into a row the one with the most values, the
/// last of several; else the last.
fn across<'a>(varying: &[&'a Axis], rows: &[usize]) -> Option<&'a Axis> {
    let count = |axis: &&&Axis| axis.among(rows).len();
    let fitting = varying.iter().filter(|axis| count(axis) <= PER_ROW);
    fitting.max_by_key(count).or(varying.last()).copied()
}
