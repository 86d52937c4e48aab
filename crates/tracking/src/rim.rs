//! The rim of what a frame shows of the sensor: where the colour of the frame's corners ends.

use crate::binned::Binned;

/// First and last square in each row and in each column of squares that does not have the colour of the corners.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rim {
    rows: Vec<Option<[usize; 2]>>,
    columns: Vec<Option<[usize; 2]>>,
}

/// How alike the corners must be, of 255.
const ALIKE: f64 = 16.0;
/// The least difference that counts as another colour, of 255.
const OTHER: f64 = 8.0;

impl Rim {
    /// Finds the rim, when at least three of the frame's four corners are alike.
    pub(crate) fn find(binned: &Binned) -> Option<Self> {
        let (colour, tolerance) = outside(binned)?;
        let (width, height) = (binned.width, binned.height);
        let differs = |x: usize, y: usize| {
            away(&colour, &binned.sums[y * width + x].map(f64::from)) > tolerance
        };
        let ends = |count: usize, differs: &dyn Fn(usize) -> bool| {
            let first = (0..count).find(|&at| differs(at))?;
            let last = (first..count).rfind(|&at| differs(at))?;
            Some([first, last])
        };
        Some(Self {
            rows: (0..height)
                .map(|y| ends(width, &|x| differs(x, y)))
                .collect(),
            columns: (0..width)
                .map(|x| ends(height, &|y| differs(x, y)))
                .collect(),
        })
    }

    /// Whether a square lies beyond the rim along its row or its column.
    pub(crate) fn excludes(&self, x: usize, y: usize) -> bool {
        let beyond = |ends: &Option<[usize; 2]>, at: usize| {
            ends.is_none_or(|[first, last]| at < first || at > last)
        };
        beyond(&self.rows[y], x) || beyond(&self.columns[x], y)
    }

    /// Points of the rim, in squares. Where another colour reaches the frame's border the rim is cut off: no point of it
    /// is seen there.
    pub(crate) fn points(&self) -> Vec<[f64; 2]> {
        let across = self.rows.iter().enumerate().filter_map(|(y, ends)| {
            let [left, right] = ends.as_ref()?;
            Some([
                [*left as f64 - 0.5, y as f64],
                [*right as f64 + 0.5, y as f64],
            ])
        });
        let down = self.columns.iter().enumerate().filter_map(|(x, ends)| {
            let [top, bottom] = ends.as_ref()?;
            Some([
                [x as f64, *top as f64 - 0.5],
                [x as f64, *bottom as f64 + 0.5],
            ])
        });
        let (right, bottom) = (
            self.columns.len() as f64 - 1.0,
            self.rows.len() as f64 - 1.0,
        );
        across
            .chain(down)
            .flatten()
            .filter(|[x, y]| *x > 0.0 && *y > 0.0 && *x < right && *y < bottom)
            .collect()
    }
}

/// The corners' colour, in sums over squares, and how far from it their squares lie.
fn outside(binned: &Binned) -> Option<([f64; 3], f64)> {
    let (width, height) = (binned.width, binned.height);
    let side = (width.min(height) / 40).max(2);
    let places = [
        (0, 0),
        (width - side, 0),
        (0, height - side),
        (width - side, height - side),
    ];
    let corners = places.map(|(x, y)| -> Vec<[f64; 3]> {
        (y..y + side)
            .flat_map(|row| &binned.sums[row * width + x..][..side])
            .map(|colour| colour.map(f64::from))
            .collect()
    });
    let means = corners.each_ref().map(|corner| mean(corner));
    let grey = binned.pixels() as f64;
    let alike = |colour: &[f64; 3]| {
        means
            .each_ref()
            .map(|other| away(colour, other) < ALIKE * grey)
    };
    let count = |alike: &[bool; 4]| alike.iter().filter(|&&alike| alike).count();
    let (alike, colour) = means
        .iter()
        .map(|colour| (alike(colour), *colour))
        .max_by_key(|(alike, _)| count(alike))?;
    if count(&alike) < 3 {
        return None;
    }
    let mut strays: Vec<f64> = corners
        .iter()
        .zip(alike)
        .filter(|(_, alike)| *alike)
        .flat_map(|(corner, _)| corner)
        .map(|value| away(&colour, value))
        .collect();
    strays.sort_by(f64::total_cmp);
    let most = strays[strays.len() * 98 / 100];
    Some((colour, (1.25 * most).max(OTHER * grey)))
}

fn mean(values: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2]
        .map(|colour| values.iter().map(|value| value[colour]).sum::<f64>() / values.len() as f64)
}

/// The largest difference of the three colours.
fn away(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}
