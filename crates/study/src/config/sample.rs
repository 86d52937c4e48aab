//! Chooses which cells of a large study are checked before the run. A cell is one combination of the swept values.

use super::grid::Grid;
use super::sweep::Axis;
use std::collections::BTreeSet;

/// Limit for the size of a study, in cells. Up to this limit, all cells of the study are checked before the run. Of
/// larger studies, only a sample of the cells is checked.
const MOST_WHOLE: usize = 10_000;
/// Limit for the length of a sweep axis, in rows; a row is a value, or a set of values that vary together. Up to this
/// limit, the sample of the study's cells contains all rows of the axis. Of longer axes, it contains only some rows.
const MOST_ROWS: usize = 1000;
/// A sample contains this number of cells that are spread evenly over all cells of the study.
const SPREAD: usize = 2000;

/// Numbers of the cells that are checked, in ascending order. They depend only on the axes. All cells of a small study
/// are checked. The sample of a large study contains:
/// - each row of each axis, once with the first rows of the other axes and once with other rows of these axes. A long
///   axis contributes only about [`MOST_ROWS`] rows: rows that are spread evenly, and its extremes
///   ([`Axis::extremes`]).
/// - for each pair of axes, all combinations of their extremes, with the first rows of the other axes.
/// - the last cell, and cells that are spread evenly.
pub(super) fn sample(grid: &Grid) -> Vec<usize> {
    let cells = grid.cells();
    if cells <= MOST_WHOLE {
        return (0..cells).collect();
    }
    let axes = &grid.axes;
    let rows: Vec<Vec<usize>> = axes
        .iter()
        .map(|axis| thinned(axis, 0..axis.len()))
        .collect();
    let mut sample: BTreeSet<usize> = star(grid, &rows).into_iter().collect();
    let mut number = 0;
    let mut next = || {
        number += 1;
        spread(number, cells)
    };
    for (place, rows) in rows.iter().enumerate() {
        for &row in rows {
            let mut other = grid.rows_of(next());
            other[place] = row;
            sample.insert(grid.cell_of(&other));
        }
    }
    for (place, one) in axes.iter().enumerate() {
        for (later, other) in axes.iter().enumerate().skip(place + 1) {
            for row in one.extremes() {
                for other_row in other.extremes() {
                    let mut rows = vec![0; axes.len()];
                    (rows[place], rows[later]) = (row, other_row);
                    sample.insert(grid.cell_of(&rows));
                }
            }
        }
    }
    sample.insert(cells - 1);
    sample.extend((0..SPREAD).map(|_| next()));
    sample.into_iter().collect()
}

/// Numbers of the cells in which every sweep axis, except at most one, is at its first used row. `rows` contains the
/// used rows of each axis.
pub(super) fn star(grid: &Grid, rows: &[Vec<usize>]) -> Vec<usize> {
    let first: Vec<usize> = rows.iter().map(|rows| rows[0]).collect();
    let mut cells = Vec::new();
    for (place, rows) in rows.iter().enumerate() {
        for &row in rows {
            let mut all = first.clone();
            all[place] = row;
            cells.push(grid.cell_of(&all));
        }
    }
    cells.push(grid.cell_of(&first));
    cells.sort_unstable();
    cells.dedup();
    cells
}

/// Selects some of the given `rows` of an axis, and returns them in ascending order. If there are at most [`MOST_ROWS`]
/// rows, all of them are returned. Otherwise, the result contains rows that are spread evenly, and the first and the
/// last of the given rows. It also contains the extremes of the axis if they are among the given rows.
pub(super) fn thinned(axis: &Axis, rows: impl IntoIterator<Item = usize>) -> Vec<usize> {
    let rows: Vec<usize> = rows.into_iter().collect();
    let (Some(&first), Some(&last)) = (rows.first(), rows.last()) else {
        return rows;
    };
    if rows.len() <= MOST_ROWS {
        return rows;
    }
    let mut few: BTreeSet<usize> = (0..MOST_ROWS)
        .map(|n| rows[spread(n, rows.len())])
        .collect();
    let extremes = axis.extremes().into_iter();
    few.extend(extremes.filter(|row| rows.binary_search(row).is_ok()));
    few.extend([first, last]);
    few.into_iter().collect()
}

/// Maps the numbers 0, 1, 2 and so on to whole numbers below `count`. The results cover the range evenly, and
/// successive results are far apart. They are the fractional parts of multiples of the golden ratio, multiplied by
/// `count`.
fn spread(number: usize, count: usize) -> usize {
    let fraction = (number as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    ((u128::from(fraction) * count as u128) >> 64) as usize
}
