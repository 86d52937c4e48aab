//! The rectangle of a patch, stretched to a square.

use crate::{Knots, Patch};

/// The square [−1, 1]² over the rectangle of a patch, in which fits are made: how much longer than
/// wide a patch is does not spoil their condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Square {
    centre: [f64; 2],
    half: [f64; 2],
}

impl Square {
    pub(crate) fn of(patch: &Patch) -> Self {
        Self {
            centre: patch.domain.map(|[low, high]| 0.5 * low + 0.5 * high),
            half: patch.domain.map(|[low, high]| 0.5 * high - 0.5 * low),
        }
    }

    /// The middle of the rectangle, in the patch's unit.
    pub(crate) const fn centre(&self) -> [f64; 2] {
        self.centre
    }

    /// Half the sides of the rectangle, in the patch's unit.
    pub(crate) const fn half(&self) -> [f64; 2] {
        self.half
    }

    /// Knots over the square as knots over the rectangle.
    pub(crate) fn knots(&self, axis: usize, square: &Knots) -> Knots {
        let place = |knot: f64| self.centre[axis] + self.half[axis] * knot;
        let (start, end) = square.domain();
        let interior: Vec<f64> = square.interior().iter().map(|&knot| place(knot)).collect();
        Knots::new(square.degree(), place(start), place(end), &interior)
    }

    /// A place of the rectangle as a place of the square.
    #[inline]
    pub(crate) fn place(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let ([u0, v0], [half_u, half_v]) = (self.centre, self.half);
        [(u - u0) / half_u, (v - v0) / half_v]
    }
}
