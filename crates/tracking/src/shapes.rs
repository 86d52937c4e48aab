//! Connected shapes in a grey image, and the windows of pixels around the shapes. A shape is stored as a list of runs;
//! a run consists of consecutive pixels in a row.

/// Consecutive pixels in a row: the columns from `first` to `last`, both included.
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

/// Pixels that are connected by edges or corners. They are stored as one or more runs, which are sorted by rows and
/// columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shape {
    pub(crate) runs: Vec<Run>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Form {
    pub(crate) middle: [f64; 2],
    /// Ratio of length to width of the ellipse with the same second moments.
    pub(crate) elongation: f64,
    /// Area of the shape divided by the area of the ellipse with the same second moments.
    pub(crate) fill: f64,
}

impl Shape {
    pub(crate) fn area(&self) -> usize {
        self.runs.iter().map(Run::len).sum()
    }

    pub(crate) fn values(&self, plane: &[u8], width: usize) -> impl Iterator<Item = u8> {
        let runs = self.runs.iter();
        runs.flat_map(move |run| &plane[run.row * width + run.first..][..run.len()])
            .copied()
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
            // Add the second moment of a run of pixels. Each pixel is a square of side 1.
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

/// Finds the shapes in the grey image `plane`: connected pixels whose value is above `limit`. The shapes are sorted by
/// their first pixels. The result is `None` if there are more than `most` shapes.
pub(crate) fn shapes(plane: &[u8], width: usize, limit: u8, most: usize) -> Option<Vec<Shape>> {
    let mut runs = Vec::new();
    for (row, line) in plane.chunks_exact(width).enumerate() {
        runs_of(line, row, limit, &mut runs);
    }
    join(&runs, most)
}

/// Number of pixels (bytes) that are tested together. If none of them is above the limit, all of them are skipped.
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

/// Joins runs into shapes. Runs belong to one shape if they touch at edges or corners. The runs must be sorted by rows
/// and columns. The result is `None` if there are more than `most` shapes.
pub(crate) fn join(runs: &[Run], most: usize) -> Option<Vec<Shape>> {
    let mut parents: Vec<usize> = (0..runs.len()).collect();
    let mut above = 0;
    for (at, run) in runs.iter().enumerate() {
        // `above` is the index of the first run in the previous row that may touch the current run or a later one. The
        // index never decreases: a run that ends left of the current run also ends left of all later runs in the
        // current row.
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

fn unite(parents: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find(parents, a), find(parents, b));
    parents[a.max(b)] = a.min(b);
}

/// A window of pixels: the first and the last column of each row, starting at row `top`. If the first column is larger
/// than the last, the row is empty.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Window {
    pub(crate) top: i32,
    pub(crate) rows: Vec<(i32, i32)>,
}

impl Window {
    /// The window of pixels that covers a shape, which was found in bins (squares) of `bin` pixels a side. In each row,
    /// the window contains all pixels from the first to the last pixel of the shape, without gaps.
    pub(crate) fn hull(shape: &Shape, bin: usize) -> Self {
        let row = |run: Option<&Run>| run.map_or(0, |run| run.row);
        let (top, bottom) = (row(shape.runs.first()), row(shape.runs.last()));
        let mut hull = vec![(i32::MAX, i32::MIN); bottom - top + 1];
        for run in &shape.runs {
            let (first, last) = &mut hull[run.row - top];
            *first = (*first).min((run.first * bin) as i32);
            *last = (*last).max(((run.last + 1) * bin) as i32 - 1);
        }
        Self {
            top: (top * bin) as i32,
            rows: hull
                .into_iter()
                .flat_map(|row| std::iter::repeat_n(row, bin))
                .collect(),
        }
    }

    /// This window, enlarged by `reach` px in all directions. `rows` contains, for each row of the frame, the first and
    /// the last column that the result may contain.
    pub(crate) fn grown(&self, reach: i32, rows: &[(i32, i32)]) -> Self {
        let top = (self.top - reach).max(0);
        let bottom = (self.top + self.rows.len() as i32 + reach).min(rows.len() as i32);
        let across: Vec<i32> = (-reach..=reach)
            .map(|down| f64::from(reach * reach - down * down).sqrt() as i32)
            .collect();
        let grown = (top..bottom)
            .map(|row| {
                let (mut first, mut last) = (i32::MAX, i32::MIN);
                for (down, across) in (-reach..).zip(&across) {
                    let (left, right) = self.row(row + down);
                    if left <= right {
                        first = first.min(left - across);
                        last = last.max(right + across);
                    }
                }
                let (left, right) = rows[row as usize];
                (first.max(left), last.min(right))
            })
            .collect();
        Self { top, rows: grown }
    }

    /// Sums of 1, x, y, x², xy and y² over the pixels of the window. x and y are offsets from `middle`.
    pub(crate) fn moments(&self, middle: [f64; 2]) -> [f64; 6] {
        let mut sums = [0.0; 6];
        for (row, &(first, last)) in (self.top..).zip(&self.rows) {
            if first > last {
                continue;
            }
            let y = f64::from(row) - middle[1];
            let count = f64::from(last - first + 1);
            let mean = 0.5 * f64::from(first + last) - middle[0];
            // The mean square of consecutive integers is the square of their mean plus their variance, (n² − 1)/12 for
            // n integers.
            let squares = count * (mean * mean + (count * count - 1.0) / 12.0);
            let terms = [1.0, mean, y, squares / count, mean * y, y * y];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += count * term;
            }
        }
        sums
    }

    /// First and last column of the window in the row `row`.
    pub(crate) fn row(&self, row: i32) -> (i32, i32) {
        usize::try_from(row - self.top)
            .ok()
            .and_then(|row| self.rows.get(row).copied())
            .unwrap_or((i32::MAX, i32::MIN))
    }

    pub(crate) fn near(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|window| {
            let (first, last) = window
                .rows
                .iter()
                .filter(|(first, last)| first <= last)
                .fold((i32::MAX, i32::MIN), |bounds, row| {
                    (bounds.0.min(row.0), bounds.1.max(row.1))
                });
            [
                first,
                last,
                window.top,
                window.top + window.rows.len() as i32 - 1,
            ]
        });
        a[0] <= b[1] && b[0] <= a[1] && a[2] <= b[3] && b[2] <= a[3]
    }
}
