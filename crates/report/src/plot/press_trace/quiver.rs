//! Figure of the markers from above, with arrows for their displacements along the skin.

use super::marker_table::{Marker, Trace};
use crate::ReportError;
use crate::phrases::with_unit;
use crate::plot::chart::{Panel, Place, mesh};
use crate::plot::drawing::Figure;
use crate::plot::scale::{Scale, Spacing, round_step};
use crate::plot::sheet::{
    self, Drawn, EDGE, HAIR, LINE, Point, SAMPLE_GAP, Sample, Sheet, TEXT, TICK_GAP, WIDTH, Words,
};
use crate::plot::style::{Colour, FRAME, INK, Marker as Shape, Style, WHITE, mixed};
use crate::plot::symbol::{Placed, Symbol};
use palpate_study::label::spoken_unit;
use plotters::element::{Circle, Polygon, Rectangle};
use plotters::style::Color;
use plotters::style::text_anchor::HPos;

/// Width of the key (legend) beside the panel, in drawing units (1/3 px).
const KEY: i32 = 720;
/// Gap between the key (legend) and the panel with the markers, in drawing units (1/3 px).
const GAP: i32 = 90;
/// Smallest displacement along the skin for which arrows are drawn, in the length unit of the tables.
const MIN_DISPLACEMENT: f64 = 1e-290;
/// Width of the arrow of a true displacement, in drawing units (1/3 px).
const TRUE: f64 = 15.0;
/// Width of the arrow of a reading, in drawing units (1/3 px). This arrow is narrower, because it is drawn on the arrow
/// of the true displacement.
const READ: f64 = 6.0;
/// Length of the symbol beside each text of the key (legend), in drawing units (1/3 px).
const SAMPLE: i32 = 120;
/// Width and height of the strip with the shades of grey in the key (legend), in drawing units (1/3 px).
const STRIP: Point = (78, 570);
const SHADES: i32 = 95;
/// Grey of the markers with the smallest normal displacement. It is light enough for arrows to be visible on it.
const LIGHT: Colour = Colour(252, 252, 252);
/// Grey of the markers with the largest normal displacement. It is light enough for arrows to be visible on it.
const DARK: Colour = Colour(130, 130, 130);

pub(super) fn figure(trace: &Trace) -> Result<Figure, ReportError> {
    let title = "Displacement of the markers along the skin";
    let words = Words::new("quiver", title, &trace.subtitle(), &[]);
    let [x, y] = scales(trace);
    let left = EDGE + y.widest() + TICK_GAP + 6;
    let side = WIDTH - left - GAP - KEY - EDGE;
    // Distance between neighbouring markers in the figure, if they were evenly spaced over the panel. The size of a
    // drawn marker is derived from this distance, so that neighbours do not touch.
    let apart = f64::from(side) / (trace.markers.len() as f64).sqrt();
    let moves = trace.markers.iter().flat_map(|marker| {
        let read = marker.reading.and_then(|reading| reading.tangential);
        marker.truth.tangential.into_iter().chain(read)
    });
    let longest = moves.map(|[x, y]| libm::hypot(x, y)).fold(0.0, f64::max);
    let normals = trace.markers.iter().map(|marker| marker.truth.normal);
    let quiver = Quiver {
        trace,
        shade: Scale::around(Spacing::Linear, normals).with_ticks(5),
        radius: (0.17 * apart).clamp(6.0, 33.0),
        longest,
        stretch: (longest > MIN_DISPLACEMENT).then(|| (0.8 * apart).clamp(36.0, 210.0) / longest),
    };
    sheet::figure(words, WIDTH, |sheet| {
        sheet.top += 60;
        let y_label = (EDGE, sheet.top - 18 + TEXT / 2);
        sheet.text(&quiver.in_unit("y"), y_label, HPos::Left, INK)?;
        sheet.top += LINE;
        let place = Place {
            corner: (left, sheet.top),
            size: (side, side),
            labelled: [true; 2],
        };
        let mut panel = place.panel(sheet, &x, &y)?;
        mesh(&mut panel)?;
        for marker in &trace.markers {
            quiver.marker(marker, &panel)?;
        }
        for marker in &trace.markers {
            quiver.arrows(marker, &panel, sheet)?;
        }
        let bottom = sheet.top + side + TICK_GAP;
        quiver.key(left + side + GAP, sheet)?;
        sheet.top = bottom + 2 * LINE + 30;
        let x_label = (left + side / 2, bottom + LINE * 3 / 2 + 24);
        sheet.text(&quiver.in_unit("x"), x_label, HPos::Center, INK)
    })
}

fn scales(trace: &Trace) -> [Scale; 2] {
    let ends = [0, 1].map(|axis| {
        let along = trace.markers.iter().map(|marker| marker.place[axis]);
        Scale::around(Spacing::Linear, along).ends()
    });
    let half = |(low, high): (f64, f64)| 0.5 * (high - low);
    let reach = half(ends[0]).max(half(ends[1]));
    ends.map(|(low, high)| {
        let middle = low + half((low, high));
        Scale::exactly(middle - reach, middle + reach)
            .with_ticks(5)
            .without_minor()
    })
}

struct Quiver<'a> {
    trace: &'a Trace,
    shade: Scale,
    radius: f64,
    /// Largest displacement of a marker along the skin, in the length unit of the tables.
    longest: f64,
    /// Length of an arrow in drawing units (1/3 px), divided by the displacement that the arrow shows. `None` if no
    /// marker moves along the skin.
    stretch: Option<f64>,
}

impl Quiver<'_> {
    /// The text `label`, followed by the length unit of the tables.
    fn in_unit(&self, label: &str) -> String {
        with_unit(label, &spoken_unit(&self.trace.unit))
    }

    /// Draws a marker at its position at rest. Its shade of grey shows its true normal displacement. A marker without a
    /// reading is crossed out.
    fn marker(&self, marker: &Marker, panel: &Panel<'_>) -> Drawn {
        let area = panel.plotting_area();
        let shade = mixed(LIGHT, DARK, self.shade.place(marker.truth.normal));
        for (radius, colour) in [(self.radius, FRAME), (self.radius - 3.0, shade)] {
            area.draw(&Circle::new(marker.place.into(), radius, colour.filled()))?;
        }
        if marker.reading.is_none() {
            let cross = lost((0.6 * self.radius).max(9.0));
            area.draw(&Placed(marker.place.into(), cross))?;
        }
        Ok(())
    }

    fn arrows(&self, marker: &Marker, panel: &Panel<'_>, sheet: &Sheet) -> Drawn {
        let read = marker.reading.and_then(|reading| reading.tangential);
        for (moved, colour, wide) in [
            (marker.truth.tangential, true_colour(), TRUE),
            (read, read_colour(), READ),
        ] {
            if let (Some([x, y]), Some(stretch)) = (moved, self.stretch) {
                let from = panel.backend_coord(&marker.place.into());
                arrow(sheet, from, (stretch * x, -stretch * y), colour, wide)?;
            }
        }
        Ok(())
    }

    fn key(&self, left: i32, sheet: &mut Sheet) -> Drawn {
        let line = |sheet: &mut Sheet, along: f64, colour: Colour, wide: f64, words: &str| {
            let y = sheet.top + TEXT / 2;
            arrow(sheet, (left, y), (along, 0.0), colour, wide)?;
            sheet.top += LINE;
            let place = (left + SAMPLE.max(along as i32) + SAMPLE_GAP, y);
            sheet.text(words, place, HPos::Left, INK)
        };
        if let Some(stretch) = self.stretch {
            let sample = f64::from(SAMPLE);
            sheet.heading("along the skin", left, KEY)?;
            line(sheet, sample, true_colour(), TRUE, "truth")?;
            if self.trace.reads_tangential {
                line(sheet, sample, read_colour(), READ, "reading")?;
            }
            let length = round_step(0.8 * self.longest);
            let words = self.trace.length(length, 1);
            line(sheet, stretch * length, INK, READ, &words)?;
        } else {
            sheet.heading("nothing along the skin", left, KEY)?;
        }
        sheet.top += LINE * 4 / 5;
        sheet.heading(&self.in_unit("inward, truth"), left, KEY)?;
        sheet.top += TEXT / 2;
        self.strip(left, sheet)?;
        if self.trace.lost() > 0 {
            let place = (left + 36, sheet.top + STRIP.1 + LINE * 6 / 5);
            for (radius, colour) in [(33, FRAME), (30, WHITE)] {
                sheet
                    .area
                    .draw(&Circle::new(place, radius, colour.filled()))?;
            }
            let cross = Sample::symbol(lost(20.0));
            sheet.entry((left, place.1), 72, &cross, "no reading")?;
        }
        Ok(())
    }

    fn strip(&self, left: i32, sheet: &Sheet) -> Drawn {
        let (right, bottom) = (left + STRIP.0, sheet.top + STRIP.1);
        for at in 0..SHADES {
            let [below, above] = [at, at + 1].map(|at| bottom - at * STRIP.1 / SHADES);
            let shade = mixed(LIGHT, DARK, (f64::from(at) + 0.5) / f64::from(SHADES));
            let band = Rectangle::new([(left, above), (right, below)], shade.filled());
            sheet.area.draw(&band)?;
        }
        let corners = [(left, sheet.top), (right, bottom)];
        sheet
            .area
            .draw(&Rectangle::new(corners, FRAME.stroke_width(HAIR)))?;
        for tick in self.shade.ticks() {
            let y = bottom - (self.shade.place(tick.at) * f64::from(STRIP.1)) as i32;
            sheet.path(vec![(right, y), (right + 15, y)], FRAME.stroke_width(HAIR))?;
            sheet.text(&tick.label, (right + 30, y), HPos::Left, INK)?;
        }
        Ok(())
    }
}

fn true_colour() -> Colour {
    Style::of(0).colour
}

fn read_colour() -> Colour {
    Style::of(1).colour
}

fn lost(size: f64) -> Symbol {
    let style = Style::new(read_colour(), Shape::Cross);
    Symbol::new(style, size)
}

/// Draws an arrow, unless it is too short to be visible.
fn arrow(
    sheet: &Sheet,
    (x, y): Point,
    (along, down): (f64, f64),
    colour: Colour,
    wide: f64,
) -> Drawn {
    let length = libm::hypot(along, down);
    if length < 3.0 {
        return Ok(());
    }
    let head = (2.0 * wide + 18.0).min(0.6 * length);
    let (east, south) = (along / length, down / length);
    let at = |forward: f64, aside: f64| {
        (
            x + (forward * east - aside * south).round() as i32,
            y + (forward * south + aside * east).round() as i32,
        )
    };
    let shaft = vec![(x, y), at(length - 0.8 * head, 0.0)];
    sheet.path(shaft, colour.stroke_width(wide as u32))?;
    let half = 0.42 * head.max(wide);
    let tip = [
        at(length, 0.0),
        at(length - head, half),
        at(length - head, -half),
    ];
    sheet.area.draw(&Polygon::new(tip, colour))
}
