//! Three-dimensional charts with the same scale along all axes.

use super::drawing::Drawing;
use super::scale::{Scale, Spacing};
use super::sheet::{Drawn, EDGE, HAIR, Sheet, TEXT, WIDTH, letters};
use super::style::{FAINT, FLOOR, INK};
use crate::phrases::with_unit;
use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::cartesian::Cartesian3d;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, TRANSPARENT};

/// A point or a direction in three dimensions.
pub(crate) type Vector = [f64; 3];

/// Horizontal angle of the direction from the object to the viewer, from +x towards −y, degrees.
const TURN: f64 = 62.0;
/// Angle of the viewer's direction above the horizontal plane, degrees.
const RAISE: f64 = 36.0;
/// Space for the labels of the axes to the left and to the right of the box, in drawing units (1/3 px).
const BESIDE: i32 = 198;
/// Space for the labels of the axes below the box, in drawing units (1/3 px).
pub(super) const BELOW: i32 = 48;
/// Largest height of the box of the three-dimensional chart, in drawing units (1/3 px).
const TALLEST: i32 = 1860;
/// Approximate distance between ticks, in drawing units (1/3 px). The number of ticks of an axis is its length divided
/// by this distance, but at least 2 and at most 6.
const APART: f64 = 192.0;

/// A three-dimensional chart of the plotters library. Its x axis points to the right, its y axis up, and its z axis
/// away from the viewer. In the tables, the z axis points up. Therefore, the coordinates y and z of the contacts are
/// swapped for this chart.
pub(super) type Space<'a> = ChartContext<'a, Drawing, Cartesian3d<Scale, Scale, Scale>>;

/// A scale that covers one coordinate of all positions `places`. `axis` is the index of the coordinate (0, 1 or 2).
pub(super) fn around(places: &[Vector], axis: usize) -> Scale {
    Scale::around(Spacing::Linear, places.iter().map(|place| place[axis]))
}

/// An orthographic view obliquely from above. All axes have the same scale.
pub(super) struct View {
    /// Unit vectors of the view: `right`, `up`, and `toward` (from the object to the viewer).
    right: Vector,
    up: Vector,
    toward: Vector,
    sides: Vector,
    pub(super) high: i32,
}

impl View {
    /// The view of a box whose axes have these scales. The box is as large as the figure allows.
    pub(super) fn of(scales: &[Scale; 3]) -> Self {
        let (sin_turn, cos_turn) = libm::sincos((-TURN).to_radians());
        let (sin, cos) = libm::sincos(RAISE.to_radians());
        let right = [-sin_turn, cos_turn, 0.0];
        let up = [-sin * cos_turn, -sin * sin_turn, cos];
        let sides = [0, 1, 2].map(|axis| scales[axis].ends().1 - scales[axis].ends().0);
        let extent = |direction: Vector| {
            let parts = (0..3).map(|axis| direction[axis].abs() * sides[axis]);
            parts.sum::<f64>()
        };
        let room = f64::from(WIDTH - 2 * (EDGE + BESIDE)) / extent(right);
        let scale = room.min(f64::from(TALLEST) / extent(up));
        Self {
            right,
            up,
            toward: [cos * cos_turn, cos * sin_turn, sin],
            sides: sides.map(|side| scale * side),
            high: (scale * extent(up)) as i32,
        }
    }

    /// Adds an empty three-dimensional chart with its walls to the sheet, below everything that is already drawn.
    pub(super) fn space<'a>(&self, sheet: &Sheet, scales: &[Scale; 3]) -> Drawn<Space<'a>> {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let about = (self.sides[axis] / APART).clamp(2.0, 6.0) as usize;
            scales[axis].clone().with_ticks(about)
        });
        let middle = [f64::from(WIDTH / 2), f64::from(sheet.top + self.high / 2)];
        let row = |direction: Vector, sign: f64, middle: f64| {
            let along = |axis: usize| sign * direction[axis];
            let centre = (0..3).map(|axis| along(axis) * self.sides[axis] / 2.0);
            [along(0), along(2), along(1), middle - centre.sum::<f64>()]
        };
        let matrix = [
            row(self.right, 1.0, middle[0]),
            row(self.up, -1.0, middle[1]),
            row(self.toward, -1.0, 0.0),
            [0.0, 0.0, 0.0, 1.0],
        ];
        let [wide, deep, high] = self.sides.map(|side| side as i32);
        // The plotters library draws the labels of an axis on the side of the box that faces away from the middle of
        // the drawing area. So the choice of the drawing area also determines where the labels are.
        let area = (sheet.area.clone()).shrink((0, sheet.top), (WIDTH, self.high));
        let mut space =
            ChartBuilder::on(&area).build_cartesian_3d(x.clone(), z.clone(), y.clone())?;
        space.set_3d_pixel_range((wide, high, deep));
        space.with_projection(|_| matrix.into());
        space
            .configure_axes()
            .axis_panel_style(FLOOR.filled())
            .bold_grid_style(FAINT.stroke_width(HAIR))
            .light_grid_style(TRANSPARENT)
            .label_style(letters(TEXT, INK, HPos::Center))
            .tick_size(15)
            .x_formatter(&|value| x.format_ext(value))
            .y_formatter(&|value| z.format_ext(value))
            .z_formatter(&|value| y.format_ext(value))
            .draw()?;
        Ok(space)
    }

    pub(super) fn name_axes(
        &self,
        space: &Space<'_>,
        sheet: &Sheet,
        unit: &str,
        scales: &[Scale; 3],
    ) -> Drawn {
        let [x, y, z] = [0, 1, 2].map(|axis| scales[axis].ends());
        let middle = |(low, high): (f64, f64)| low + (high - low) / 2.0;
        for (name, place, (dx, dy), anchor) in [
            ("x", [middle(x), y.0, z.0], (-108, 132), HPos::Center),
            ("y", [x.1, middle(y), z.0], (156, 102), HPos::Left),
            ("z", [x.0, y.0, z.1], (-30, -42), HPos::Right),
        ] {
            let (x, y) = space.plotting_area().map_coordinate(&at(place));
            sheet.text(&with_unit(name, unit), (x + dx, y + dy), anchor, INK)?;
        }
        Ok(())
    }
}

/// Converts a position to the coordinates of the chart, in which y and z are swapped.
pub(super) fn at([x, y, z]: Vector) -> (f64, f64, f64) {
    (x, z, y)
}
