//! Axes around a panel.

use super::drawing::Drawing;
use super::scale::Scale;
use super::sheet::{Drawn, HAIR, Point, Sheet, TEXT, letters};
use super::style::{Colour, FAINT, FRAME, GRID, INK};
use plotters::chart::{ChartBuilder, ChartContext, LabelAreaPosition};
use plotters::coord::cartesian::Cartesian2d;
use plotters::element::{PathElement, Rectangle};
use plotters::style::Color;
use plotters::style::text_anchor::HPos;

/// Length of a tick mark, and gap between the mark and its label.
const TICK: i32 = 15;
/// Size of the label areas of plotters; labels may extend beyond them.
const LABELS: i32 = 60;

/// A chart of plotters with axes of type [`Scale`].
pub(crate) type Panel<'a> = ChartContext<'a, Drawing, Cartesian2d<Scale, Scale>>;

/// Place of a panel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// Upper left corner.
    pub(crate) corner: Point,
    /// Width and height.
    pub(crate) size: Point,
    /// Whether ticks of x and of y are labelled.
    pub(crate) labelled: [bool; 2],
}

impl Place {
    /// Makes the empty panel at this place.
    pub(crate) fn panel<'a>(&self, sheet: &Sheet, x: &Scale, y: &Scale) -> Drawn<Panel<'a>> {
        let [below, beside] = self.labelled.map(|labelled| LABELS * i32::from(labelled));
        let corner = (self.corner.0 - beside, self.corner.1);
        let size = (self.size.0 + beside, self.size.1 + below);
        ChartBuilder::on(&sheet.area.clone().shrink(corner, size))
            .set_label_area_size(LabelAreaPosition::Left, beside)
            .set_label_area_size(LabelAreaPosition::Bottom, below)
            .build_cartesian_2d(x.clone(), y.clone())
    }
}

/// Draws grid, outline, and ticks with their labels.
pub(crate) fn mesh(panel: &mut Panel<'_>) -> Drawn {
    let frame = FRAME.stroke_width(HAIR);
    panel
        .configure_mesh()
        .light_line_style(FAINT.stroke_width(HAIR))
        .bold_line_style(GRID.stroke_width(HAIR))
        .axis_style(frame)
        .label_style(letters(TEXT, INK, HPos::Left))
        .set_all_tick_mark_size(TICK)
        .draw()?;
    outline(panel)
}

/// Draws the outline.
pub(crate) fn outline(panel: &Panel<'_>) -> Drawn {
    let area = panel.plotting_area().strip_coord_spec();
    let (wide, high) = area.dim_in_pixel();
    let corners = [(0, 0), (wide as i32, high as i32)];
    area.draw(&Rectangle::new(corners, FRAME.stroke_width(HAIR)))
}

/// Draws an error bar from `ends[0]` to `ends[1]` at `x`, unless the marker, `hidden` px high, covers it. Ends
/// outside the panel have no caps.
pub(crate) fn bar(panel: &Panel<'_>, x: f64, ends: [f64; 2], hidden: i32, colour: Colour) -> Drawn {
    const HALF_CAP: i32 = 12;
    let area = panel.plotting_area().use_screen_coord();
    let (_, down) = area.get_pixel_range();
    let [low, high] = ends.map(|end| panel.backend_coord(&(x, end)));
    if low.1.min(down.end) - high.1.max(down.start) <= hidden {
        return Ok(());
    }
    let style = colour.stroke_width(4);
    area.draw(&PathElement::new([low, high], style))?;
    for (x, y) in [low, high] {
        if down.contains(&y) {
            let cap = [(x - HALF_CAP, y), (x + HALF_CAP, y)];
            area.draw(&PathElement::new(cap, style))?;
        }
    }
    Ok(())
}
