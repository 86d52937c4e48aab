//! The pixels of the frame about a shape: its hull along rows, grown.

use crate::image_circle::Mask;
use crate::shapes::Shape;

/// For rows from `top` on, the first and last column; none where the first is greater.
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

    /// All pixels within `reach` px of this window's, kept inside the circle and the frame of `size` columns and rows.
    pub(crate) fn grown(&self, reach: i32, mask: &Mask, size: [usize; 2]) -> Self {
        let top = (self.top - reach).max(0);
        let bottom = (self.top + self.rows.len() as i32 + reach).min(size[1] as i32);
        let rows = (top..bottom)
            .map(|row| {
                let (mut first, mut last) = (i32::MAX, i32::MIN);
                for down in -reach..=reach {
                    let (left, right) = self.row(row + down);
                    if left <= right {
                        let across = f64::from(reach * reach - down * down).sqrt() as i32;
                        first = first.min(left - across);
                        last = last.max(right + across);
                    }
                }
                let (left, right) = mask.columns(f64::from(row), 0.0, size[0]);
                (first.max(left as i32), last.min(right as i32 - 1))
            })
            .collect();
        Self { top, rows }
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
