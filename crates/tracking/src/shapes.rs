//! Connected shapes in a plane: runs of pixels, joined over rows.

/// Pixels side by side in a row: columns from `first` to `last`, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) row: usize,
    pub(crate) first: usize,
    pub(crate) last: usize,
}

impl Run {
    pub(crate) fn len(&self) -> usize {
        self.last - self.first + 1
    }
}

/// Pixels that hang together, over edges or corners; at least one, by rows and columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shape {
    pub(crate) runs: Vec<Run>,
}

/// Second moments of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Form {
    pub(crate) middle: [f64; 2],
    /// Length over breadth of the ellipse with the same second moments.
    pub(crate) elongation: f64,
    /// Area over that of the ellipse with the same second moments.
    pub(crate) fill: f64,
}

impl Shape {
    pub(crate) fn area(&self) -> usize {
        self.runs.iter().map(Run::len).sum()
    }

    pub(crate) fn first_row(&self) -> usize {
        self.runs.first().map_or(0, |run| run.row)
    }

    pub(crate) fn last_row(&self) -> usize {
        self.runs.last().map_or(0, |run| run.row)
    }

    pub(crate) fn form(&self) -> Form {
        let (mut area, mut x, mut y, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for run in &self.runs {
            let length = run.len() as f64;
            let middle = 0.5 * (run.first + run.last) as f64;
            let row = run.row as f64;
            area += length;
            x += length * middle;
            y += length * row;
            // The second moment of a run of pixels, each a square of side 1.
            xx += length * (middle * middle + length * length / 12.0);
            xy += length * middle * row;
            yy += length * (row * row + 1.0 / 12.0);
        }
        let middle = [x / area, y / area];
        let (xx, xy, yy) = (
            xx / area - middle[0] * middle[0],
            xy / area - middle[0] * middle[1],
            yy / area - middle[1] * middle[1],
        );
        let (half, spread) = (0.5 * (xx + yy), libm::hypot(0.5 * (xx - yy), xy));
        let (long, short) = (half + spread, (half - spread).max(1e-9));
        Form {
            middle,
            elongation: (long / short).sqrt(),
            fill: area / (4.0 * std::f64::consts::PI * (long * short).sqrt()),
        }
    }
}

/// The shapes of the pixels above `limit` in a plane, in the order of their first pixels; `None` if there are more than
/// `most`.
pub(crate) fn shapes(plane: &[u8], width: usize, limit: u8, most: usize) -> Option<Vec<Shape>> {
    let mut runs = Vec::new();
    for (row, line) in plane.chunks_exact(width).enumerate() {
        runs_of(line, row, limit, &mut runs);
    }
    join(&runs, most)
}

/// Bytes looked at together where nothing is above the limit.
const STRETCH: usize = 32;

fn runs_of(line: &[u8], row: usize, limit: u8, runs: &mut Vec<Run>) {
    let mut column = 0;
    while column < line.len() {
        let rest = &line[column..];
        if let Some(stretch) = rest.first_chunk::<STRETCH>()
            && stretch
                .iter()
                .fold(0, |greatest, &value| value.max(greatest))
                <= limit
        {
            column += STRETCH;
            continue;
        }
        let end = column + rest.len().min(STRETCH);
        while column < end {
            if line[column] <= limit {
                column += 1;
                continue;
            }
            let first = column;
            while column < line.len() && line[column] > limit {
                column += 1;
            }
            runs.push(Run {
                row,
                first,
                last: column - 1,
            });
        }
    }
}

/// Joins runs, sorted by rows and columns, that touch over edges or corners.
pub(crate) fn join(runs: &[Run], most: usize) -> Option<Vec<Shape>> {
    let mut parents: Vec<usize> = (0..runs.len()).collect();
    let mut above = 0;
    for (at, run) in runs.iter().enumerate() {
        // `above` only moves forward: runs that end left of this one's reach end left of all later ones' in this row.
        while above < at
            && (runs[above].row + 1 < run.row
                || runs[above].row + 1 == run.row && runs[above].last + 1 < run.first)
        {
            above += 1;
        }
        let mut other = above;
        while other < at && runs[other].row + 1 == run.row && runs[other].first <= run.last + 1 {
            unite(&mut parents, other, at);
            other += 1;
        }
    }
    let mut shapes: Vec<Shape> = Vec::new();
    let mut places = vec![usize::MAX; runs.len()];
    for (at, run) in runs.iter().enumerate() {
        let root = find(&mut parents, at);
        if places[root] == usize::MAX {
            if shapes.len() == most {
                return None;
            }
            places[root] = shapes.len();
            shapes.push(Shape::default());
        }
        shapes[places[root]].runs.push(*run);
    }
    Some(shapes)
}

fn find(parents: &mut [usize], mut at: usize) -> usize {
    while parents[at] != at {
        parents[at] = parents[parents[at]];
        at = parents[at];
    }
    at
}

/// The earlier of two roots becomes the root of both.
fn unite(parents: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find(parents, a), find(parents, b));
    parents[a.max(b)] = a.min(b);
}
