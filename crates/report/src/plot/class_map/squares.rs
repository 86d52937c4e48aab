//! A grid of squares as few shapes: bands of one class, and the lines between classes.

use super::table::Class;

/// Squares of one class that fill a rectangle: lines `x.0..x.1` by `y.0..y.1` of the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Band {
    pub(crate) class: Class,
    pub(crate) x: (usize, usize),
    pub(crate) y: (usize, usize),
}

/// The bands of a `side` × `side` grid, x slowest: equal neighbours along y joined, and equal lines along x.
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

/// An edge between squares, from one corner of the grid to another: (x, y), each from 0 to `side`.
pub(crate) type Edge = [(usize, usize); 2];

/// The edges between squares of different classes, straight ones joined.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 × 3, x slowest:
    /// ```text
    /// x = 0: a a b      x = 1: a a b      x = 2: b b b
    /// ```
    const GRID: [Class; 9] = [
        Some(0),
        Some(0),
        Some(1),
        Some(0),
        Some(0),
        Some(1),
        Some(1),
        Some(1),
        Some(1),
    ];

    #[test]
    fn bands_cover_each_square_once_with_its_class() {
        let bands = bands(3, &GRID);
        assert_eq!(bands.len(), 3);
        let mut covered = [None; 9];
        for band in bands {
            for x in band.x.0..band.x.1 {
                for y in band.y.0..band.y.1 {
                    assert_eq!(covered[3 * x + y], None);
                    covered[3 * x + y] = Some(band.class);
                }
            }
        }
        assert_eq!(covered, GRID.map(Some));
    }

    #[test]
    fn boundaries_are_straight_lines_around_the_corner() {
        let mut found = boundaries(3, &GRID);
        found.sort_unstable();
        assert_eq!(found, [[(0, 2), (2, 2)], [(2, 0), (2, 2)]]);
        assert!(boundaries(1, &GRID[..1]).is_empty());
    }
}
