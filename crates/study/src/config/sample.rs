//! Chooses which cells of a large study are checked before the run.

use super::grid::Grid;
use super::sweep::Axis;
use std::collections::BTreeSet;

/// If a study has at most this number of cells, all its cells are checked before the run.
const MOST_WHOLE: usize = 10_000;
/// If a sweep axis has at most this number of rows, all its rows are in the sample of the study's cells.
const MOST_ROWS: usize = 1000;
/// Number of cells in a sample that are spread evenly over all cells of the study.
const SPREAD: usize = 2000;

/// Numbers of the cells that are checked, in ascending order. They depend only on the axes. A small study is checked
/// completely. The sample of a large study has
/// - each row of an axis, once with the first rows of the other axes and once with other rows of these axes. Of a long
///   axis, only [`MOST_ROWS`] rows are used: rows that are spread evenly, and its extremes ([`Axis::extremes`]).
/// - for each pair of axes, the combinations of their extremes, with the first rows of the other axes.
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

/// Numbers of the cells in which at most one axis differs from its first row in `rows`. `rows` contains, for each axis,
/// the rows that are used.
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

/// Sample of the given rows of an axis, in ascending order. If there are at most [`MOST_ROWS`] rows, all of them are
/// returned. Otherwise, the sample contains rows that are spread evenly, the first and the last given row, and those
/// given rows that are extremes of the axis.
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

/// Maps the numbers 0, 1, 2 and so on to numbers below `count` that cover the range evenly. Successive results are far
/// apart. They are the fractional parts of multiples of the golden ratio, scaled to the range.
fn spread(number: usize, count: usize) -> usize {
    let fraction = (number as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    ((u128::from(fraction) * count as u128) >> 64) as usize
}
