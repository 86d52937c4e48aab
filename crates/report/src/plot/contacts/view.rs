//! From places in space to places in a picture: an orthographic view from above, the same scale along all axes.

use super::table::Vector;
use crate::plot::canvas::Point;
use crate::plot::scale::Scale;

/// The direction to the eye: turned from +x to −y, then raised, in degrees.
const TURN: f64 = 62.0;
const RAISE: f64 = 36.0;

/// A view of a box. +x and +y lead to the right, +z upward; the walls x = least and y = most are behind.
pub(crate) struct View {
    /// The box.
    pub(crate) axes: [Scale; 3],
    centre: Vector,
    right: Vector,
    up: Vector,
    toward: Vector,
    /// Pixels per unit of length.
    scale: f64,
    middle: Point,
}

impl View {
    /// The view of a box that fills a picture of `size` from `corner` (its upper left) on, as far as it can.
    pub(crate) fn new(axes: [Scale; 3], corner: Point, size: (f64, f64)) -> Self {
        let (turn, raise) = ((-TURN).to_radians(), RAISE.to_radians());
        let mut view = Self {
            centre: [0, 1, 2].map(|k| middle(axes[k].ends())),
            axes,
            right: [-libm::sin(turn), libm::cos(turn), 0.0],
            up: [
                -libm::sin(raise) * libm::cos(turn),
                -libm::sin(raise) * libm::sin(turn),
                libm::cos(raise),
            ],
            toward: [
                libm::cos(raise) * libm::cos(turn),
                libm::cos(raise) * libm::sin(turn),
                libm::sin(raise),
            ],
            scale: 1.0,
            middle: (0.0, 0.0),
        };
        let (wide, high) = view.extent();
        view.scale = (size.0 / wide).min(size.1 / high);
        view.middle = (corner.0 + size.0 / 2.0, corner.1 + view.scale * high / 2.0);
        view
    }

    /// Width and height of the box's picture.
    pub(crate) fn extent(&self) -> (f64, f64) {
        let side = |direction: Vector| {
            let parts = (0..3).map(|k| {
                let (low, high) = self.axes[k].ends();
                direction[k].abs() * (high - low)
            });
            self.scale * parts.sum::<f64>()
        };
        (side(self.right), side(self.up))
    }

    /// Point of the picture at which a place is seen.
    pub(crate) fn at(&self, place: Vector) -> Point {
        (
            self.middle.0 + self.scale * self.along(place, self.right),
            self.middle.1 - self.scale * self.along(place, self.up),
        )
    }

    /// Nearness of a place to the eye.
    pub(crate) fn nearness(&self, place: Vector) -> f64 {
        self.along(place, self.toward)
    }

    /// The place in the box at these shares of its sides.
    pub(crate) fn inside(&self, shares: Vector) -> Vector {
        [0, 1, 2].map(|k| {
            let (low, high) = self.axes[k].ends();
            low + shares[k] * (high - low)
        })
    }

    /// Length of a side of the box in the picture, in pixels.
    pub(crate) fn side(&self, axis: usize) -> f64 {
        let (mut from, mut to) = ([0.0; 3], [0.0; 3]);
        (from[axis], to[axis]) = (0.0, 1.0);
        let (a, b) = (self.at(self.inside(from)), self.at(self.inside(to)));
        libm::hypot(b.0 - a.0, b.1 - a.1)
    }

    fn along(&self, place: Vector, direction: Vector) -> f64 {
        (0..3)
            .map(|k| (place[k] - self.centre[k]) * direction[k])
            .sum()
    }
}

fn middle((low, high): (f64, f64)) -> f64 {
    low + (high - low) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_fills_the_picture_and_the_axes_lead_where_they_should() {
        let axes = [1.0, 2.0, 0.5].map(|side| Scale::exactly(0.0, side));
        let view = View::new(axes, (10.0, 20.0), (400.0, 300.0));
        let corners: Vec<Point> = (0..8)
            .map(|k| view.at(view.inside([0, 1, 2].map(|axis| f64::from(k >> axis & 1)))))
            .collect();
        let ends = |pick: fn(&Point) -> f64| {
            let low = corners.iter().map(pick).fold(f64::INFINITY, f64::min);
            (
                low,
                corners.iter().map(pick).fold(f64::NEG_INFINITY, f64::max),
            )
        };
        let ((left, right), (top, bottom)) = (ends(|p| p.0), ends(|p| p.1));
        assert!((left - 10.0).abs() < 1e-9 || (bottom - top - 300.0).abs() < 1e-9);
        assert!(left > 10.0 - 1e-9 && right < 410.0 + 1e-9 && (top - 20.0).abs() < 1e-9);
        let origin = view.at([0.0; 3]);
        let (x, y, z) = (
            view.at([1.0, 0.0, 0.0]),
            view.at([0.0, 1.0, 0.0]),
            view.at([0.0, 0.0, 0.5]),
        );
        assert!(x.0 > origin.0 && x.1 > origin.1);
        assert!(y.0 > origin.0 && y.1 < origin.1);
        assert!((z.0 - origin.0).abs() < 1e-9 && z.1 < origin.1);
        assert!(view.nearness([1.0, 0.0, 0.0]) > view.nearness([0.0, 1.0, 0.0]));
    }
}
