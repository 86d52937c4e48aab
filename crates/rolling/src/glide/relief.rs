//! Relief of the object under a tip: the height at which each place would hold the tip.

use nalgebra::Vector2;
use palpate_geometry::Surface;

/// Grid lines on each side of the middle.
const HALF: usize = 12;
const SIDE: usize = 2 * HALF + 1;

/// The height at which the tip's centre would rest on each place of a square grid under it, −∞
/// where there is none. The contact met first is the highest place of all.
pub(super) struct Relief {
    centre: Vector2<f64>,
    spacing: f64,
    heights: [[f64; SIDE]; SIDE],
}

impl Relief {
    /// The relief about `centre`, as far as a tip of `radius` covers.
    pub(super) fn under<S: Surface>(object: &S, centre: Vector2<f64>, radius: f64) -> Self {
        let mut relief = Self {
            centre,
            spacing: radius / HALF as f64,
            heights: [[f64::NEG_INFINITY; SIDE]; SIDE],
        };
        for row in 0..SIDE {
            for column in 0..SIDE {
                let at = relief.place(row, column);
                let aside = (at - centre).norm();
                if aside <= radius
                    && let Ok(place) = object.contact_at(at.x, at.y)
                {
                    let rise = (radius - aside) * (radius + aside);
                    relief.heights[row][column] = place.z + rise.sqrt();
                }
            }
        }
        relief
    }

    /// The height of the highest place.
    pub(super) fn summit(&self) -> f64 {
        self.heights
            .iter()
            .flatten()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The places that none of their neighbours tops.
    pub(super) fn tops(&self) -> impl Iterator<Item = Vector2<f64>> + '_ {
        let places = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (row, column)));
        places
            .filter(|&(row, column)| self.is_top(row, column))
            .map(|(row, column)| self.place(row, column))
    }

    fn is_top(&self, row: usize, column: usize) -> bool {
        let height = self.heights[row][column];
        let around = |line: usize| line.saturating_sub(1)..(line + 2).min(SIDE);
        height > f64::NEG_INFINITY
            && around(row).all(|r| around(column).all(|c| self.heights[r][c] <= height))
    }

    fn place(&self, row: usize, column: usize) -> Vector2<f64> {
        let step = |line: usize| line as f64 - HALF as f64;
        self.centre + Vector2::new(step(column), step(row)) * self.spacing
    }
}
