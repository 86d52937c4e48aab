//! The pixels of the frame about a shape: its hull along rows, grown.

use crate::shapes::Shape;

/// First and last column of each row from `top` on; a row has none where the first is greater.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Window {
    pub(crate) top: i32,
    pub(crate) rows: Vec<(i32, i32)>,
}

impl Window {
    /// The pixels of a shape of squares of `bin` pixels a side, the gaps in its rows closed.
    pub(crate) fn hull(shape: &Shape, bin: usize) -> Self {
        let (top, bottom) = (shape.first_row(), shape.last_row());
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

    /// All pixels within `reach` px of this window's that lie between the first and last column of `rows`.
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

    /// Sums over its pixels of 1, x, y, x², xy and y², with the pixel at `middle` at (0, 0).
    pub(crate) fn moments(&self, middle: [f64; 2]) -> [f64; 6] {
        let mut sums = [0.0; 6];
        for (row, &(first, last)) in (self.top..).zip(&self.rows) {
            if first > last {
                continue;
            }
            let y = f64::from(row) - middle[1];
            let count = f64::from(last - first + 1);
            let mean = 0.5 * f64::from(first + last) - middle[0];
            // Variance of whole numbers side by side.
            let squares = count * (mean * mean + (count * count - 1.0) / 12.0);
            let terms = [1.0, mean, y, squares / count, mean * y, y * y];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += count * term;
            }
        }
        sums
    }

    /// First and last column of a row.
    pub(crate) fn row(&self, row: i32) -> (i32, i32) {
        usize::try_from(row - self.top)
            .ok()
            .and_then(|row| self.rows.get(row).copied())
            .unwrap_or((i32::MAX, i32::MIN))
    }

    /// Whether the rectangles about two windows meet.
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
