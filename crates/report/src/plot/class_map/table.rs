//! `map.csv`: the classes of shape over the grid of each cell.

use crate::ReportError;
use crate::plot::request::Request;
use crate::plot::style::CLASSES;
use crate::records::Records;

/// Columns read, in this order; the others are not for a picture of classes.
const COLUMNS: [&str; 5] = ["cell", "x", "y", "class", "true_class"];

/// A class as its place in [`CLASSES`]; none where the table leaves it empty.
pub(crate) type Class = Option<usize>;

/// The maps of a table, in order of appearance.
#[derive(Debug)]
pub(crate) struct Maps {
    /// Unit of x and y as in the table; may be empty.
    pub(crate) unit: String,
    pub(crate) cells: Vec<CellMap>,
}

/// Map of one cell: `side` × `side` points, x slowest.
#[derive(Debug)]
pub(crate) struct CellMap {
    pub(crate) cell: u64,
    pub(crate) side: usize,
    /// Mean x of each line of points that share it, rising.
    pub(crate) x: Vec<f64>,
    /// Mean y of each line of points that share it, rising.
    pub(crate) y: Vec<f64>,
    pub(crate) estimated: Vec<Class>,
    pub(crate) truth: Vec<Class>,
}

impl CellMap {
    /// Share of the points of known class that are classified so; none if no class is known.
    pub(crate) fn share_correct(&self) -> Option<f64> {
        let known = self.truth.iter().zip(&self.estimated);
        let known: Vec<_> = known.filter(|(truth, _)| truth.is_some()).collect();
        let correct = known.iter().filter(|(truth, found)| truth == found).count();
        (!known.is_empty()).then(|| correct as f64 / known.len() as f64)
    }
}

/// Reads `map.csv`.
pub(super) fn read(of: Request<'_>) -> Result<Maps, ReportError> {
    let table = Records::read(of.study.files(), "map.csv", &COLUMNS)?.filled()?;
    let cells = table.by_cell(0)?;
    let map = |(cell, rows): &(u64, Vec<usize>)| cell_map(of, &table, *cell, rows);
    Ok(Maps {
        unit: table.unit(1).to_owned(),
        cells: cells.iter().map(map).collect::<Result<_, _>>()?,
    })
}

fn cell_map(
    of: Request<'_>,
    table: &Records,
    cell: u64,
    rows: &[usize],
) -> Result<CellMap, ReportError> {
    let side = rows.len().isqrt();
    if side * side != rows.len() {
        let count = rows.len();
        return Err(of.bad(format!(
            "map.csv has {count} points of cell {cell}, which is no square grid"
        )));
    }
    let column = |at: usize| -> Result<Vec<f64>, ReportError> {
        rows.iter().map(|row| table.number(*row, at)).collect()
    };
    let (x, y) = (column(1)?, column(2)?);
    let mean = |line: &dyn Fn(usize) -> f64| (0..side).map(|k| line(k) / side as f64).sum::<f64>();
    let x: Vec<f64> = (0..side).map(|i| mean(&|j| x[i * side + j])).collect();
    let y: Vec<f64> = (0..side).map(|j| mean(&|i| y[i * side + j])).collect();
    for (name, lines) in [("x", &x), ("y", &y)] {
        if lines.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(of.bad(format!(
                "the points of cell {cell} in map.csv are no grid of {side} × {side} with x slowest: {name} does not rise"
            )));
        }
    }
    let classes = |at: usize| -> Result<Vec<Class>, ReportError> {
        rows.iter().map(|row| class(table, *row, at)).collect()
    };
    Ok(CellMap {
        cell,
        side,
        x,
        y,
        estimated: classes(3)?,
        truth: classes(4)?,
    })
}

fn class(table: &Records, row: usize, column: usize) -> Result<Class, ReportError> {
    let text = table.text(row, column);
    let known = CLASSES.iter().position(|(name, _)| *name == text);
    match (known, text) {
        (None, "") | (Some(_), _) => Ok(known),
        (None, _) => Err(table.bad(row, column, "one of the eight classes of shape")),
    }
}
