//! Reads the shape class of each point from `map.csv`. For each map, computes coloured rectangles that show the
//! classes, and the boundaries between classes.

use super::selection::Request;
use super::style::CLASSES;
use crate::ReportError;
use crate::records::Records;

/// Names of the columns that are read from `map.csv`. The code refers to them by their index in this list.
const COLUMNS: [&str; 5] = ["cell", "x", "y", "class", "true_class"];

/// Index of a shape class in [`CLASSES`]; `None` for a point without a class.
pub(crate) type Class = Option<usize>;

/// Class maps of all cells of a study, in the order of `map.csv`.
#[derive(Debug)]
pub(crate) struct Maps {
    /// Unit of x and y in the header of `map.csv`; may be empty.
    pub(crate) unit: String,
    pub(crate) cells: Vec<CellMap>,
}

/// Map of one cell of the study: a grid of `side` × `side` points, sorted by x; points with the same x are sorted by y.
#[derive(Debug)]
pub(crate) struct CellMap {
    pub(crate) cell: u64,
    pub(crate) side: usize,
    /// Coordinate x of each grid line that is parallel to the y axis, in ascending order. It is the mean x of the
    /// points on this line.
    pub(crate) x: Vec<f64>,
    /// Coordinate y of each grid line that is parallel to the x axis, in ascending order. It is the mean y of the
    /// points on this line.
    pub(crate) y: Vec<f64>,
    pub(crate) estimated: Vec<Class>,
    pub(crate) truth: Vec<Class>,
}

impl CellMap {
    /// Share of correctly classified points among the points with a true class; `None` if no point has a true class.
    pub(crate) fn share_correct(&self) -> Option<f64> {
        let known = self.truth.iter().zip(&self.estimated);
        let known: Vec<_> = known.filter(|(truth, _)| truth.is_some()).collect();
        let correct = known.iter().filter(|(truth, found)| truth == found).count();
        (!known.is_empty()).then(|| correct as f64 / known.len() as f64)
    }
}

pub(crate) fn read(of: Request<'_>) -> Result<Maps, ReportError> {
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
            "map.csv has {count} points of cell {cell}, which do not form a square grid"
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
                "cell {cell} of map.csv is not a {side} × {side} grid with x slowest: {name} does not increase"
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

/// A rectangle of neighbouring grid squares that have the same class. Along x, it contains the squares with the indices
/// from `x.0` to `x.1` − 1; along y, from `y.0` to `y.1` − 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Band {
    pub(crate) class: Class,
    pub(crate) x: (usize, usize),
    pub(crate) y: (usize, usize),
}

/// Covers the grid of squares around the points of a map with a small number of rectangles. All squares in a rectangle
/// have the same class. First, neighbouring squares of the same class are joined along y. Then, neighbouring columns
/// with equal classes are joined along x. `classes` are sorted by x, then by y.
pub(crate) fn bands(side: usize, classes: &[Class]) -> Vec<Band> {
    let mut bands: Vec<Band> = Vec::new();
    let mut start = 0;
    while start < side {
        let line = |i: usize| &classes[i * side..(i + 1) * side];
        let same = (start..side)
            .take_while(|i| line(*i) == line(start))
            .count();
        let mut along = 0;
        for run in line(start).chunk_by(|a, b| a == b) {
            bands.push(Band {
                class: run[0],
                x: (start, start + same),
                y: (along, along + run.len()),
            });
            along += run.len();
        }
        start += same;
    }
    bands
}

/// Edge between two grid squares: the corners (x, y) at its two ends. The coordinates are counted in grid squares, so
/// they are whole numbers from 0 to `side`.
pub(crate) type Edge = [(usize, usize); 2];

pub(crate) fn boundaries(side: usize, classes: &[Class]) -> Vec<Edge> {
    let mut edges = Vec::new();
    for across in 1..side {
        let mut run = |differs: &dyn Fn(usize) -> bool,
                       corner: &dyn Fn(usize) -> (usize, usize)| {
            let mut from = None;
            for k in 0..=side {
                match (k < side && differs(k), from) {
                    (true, None) => from = Some(k),
                    (false, Some(start)) => {
                        edges.push([corner(start), corner(k)]);
                        from = None;
                    }
                    _ => {}
                }
            }
        };
        run(
            &|y| classes[(across - 1) * side + y] != classes[across * side + y],
            &|y| (across, y),
        );
        run(
            &|x| classes[x * side + across - 1] != classes[x * side + across],
            &|x| (x, across),
        );
    }
    edges
}
