//! Drawing a laid-out class map.

use super::layout::{Layout, Panel, SAMPLE, Sample};
use super::table::Class;
use crate::plot::canvas::{Anchor, Canvas, Drawn, Point};
use crate::plot::draw::{FRAME, INK, QUIET, WHITE, paragraph};
use crate::plot::layout::{EDGE, LEADING, TEXT, TICK_GAP, TITLE};
use crate::plot::style::CLASSES;
use plotters::prelude::{DrawingBackend, RGBColor};

/// Bands reach this far under those painted later, so that no seam shows between them.
const OVERLAP: f64 = 1.0;
const BOUNDARY: f64 = 1.6;

/// Draws the map.
pub(crate) fn draw<B: DrawingBackend>(layout: &Layout, canvas: &Canvas<B>) -> Drawn {
    canvas.fill(WHITE)?;
    let y = paragraph(canvas, &layout.title, EDGE, TITLE, INK)?;
    paragraph(canvas, &layout.subtitle, y, TEXT, QUIET)?;
    paragraph(canvas, &layout.notes, layout.notes_at, TEXT, QUIET)?;
    for (place, sample, text) in &layout.key {
        key(*place, *sample, text, canvas)?;
    }
    for (place, text) in &layout.headings {
        canvas.text(text, *place, TEXT, Anchor::Left, INK)?;
    }
    for panel in &layout.panels {
        Frame { layout, panel }.draw(canvas)?;
    }
    let (place, text) = &layout.x_label;
    canvas.text(text, *place, TEXT, Anchor::Middle, INK)
}

fn colour(class: Class) -> RGBColor {
    class
        .and_then(|at| CLASSES.get(at))
        .map_or(WHITE, |(_, colour)| *colour)
}

fn key<B: DrawingBackend>((x, y): Point, sample: Sample, text: &str, canvas: &Canvas<B>) -> Drawn {
    let half = SAMPLE / 2.0;
    match sample {
        Sample::Class(class) => {
            let square = [
                (x, y - half),
                (x + SAMPLE, y - half),
                (x + SAMPLE, y + half),
                (x, y + half),
            ];
            canvas.polygon(&square, colour(class))?;
            outline(&square, canvas)?;
        }
        Sample::Boundary => canvas.line(&[(x, y), (x + SAMPLE, y)], INK, BOUNDARY)?,
    }
    canvas.text(text, (x + SAMPLE + 8.0, y), TEXT, Anchor::Left, INK)
}

fn outline<B: DrawingBackend>(corners: &[Point; 4], canvas: &Canvas<B>) -> Drawn {
    let [a, b, c, d] = *corners;
    canvas.line(&[a, b, c, d, a], FRAME, 1.0)
}

/// One panel in its place.
struct Frame<'a> {
    layout: &'a Layout,
    panel: &'a Panel,
}

impl Frame<'_> {
    fn x(&self, value: f64) -> f64 {
        self.panel.corner.0 + self.layout.x.place(value) * self.layout.panel.0
    }

    fn y(&self, value: f64) -> f64 {
        self.panel.corner.1 + (1.0 - self.layout.y.place(value)) * self.layout.panel.1
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        let (left, top) = self.panel.corner;
        let (right, bottom) = (left + self.layout.panel.0, top + self.layout.panel.1);
        // In order of rising x and y: each covers what the one before reaches into it.
        for band in &self.panel.bands {
            let (x0, x1) = (
                self.x(self.panel.x[band.x.0]),
                self.x(self.panel.x[band.x.1]),
            );
            let (y0, y1) = (
                self.y(self.panel.y[band.y.0]),
                self.y(self.panel.y[band.y.1]),
            );
            let (x1, y1) = ((x1 + OVERLAP).min(right), (y1 - OVERLAP).max(top));
            canvas.polygon(
                &[(x0, y0), (x1, y0), (x1, y1), (x0, y1)],
                colour(band.class),
            )?;
        }
        for edge in &self.panel.boundaries {
            let end = |(i, j): (usize, usize)| (self.x(self.panel.x[i]), self.y(self.panel.y[j]));
            canvas.line(&edge.map(end), INK, BOUNDARY)?;
        }
        outline(
            &[(left, top), (right, top), (right, bottom), (left, bottom)],
            canvas,
        )?;
        self.labels(canvas)
    }

    fn labels<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        let (left, top) = self.panel.corner;
        let (right, bottom) = (left + self.layout.panel.0, top + self.layout.panel.1);
        for tick in &self.panel.x_ticks {
            let x = self.x(tick.at);
            canvas.line(&[(x, bottom), (x, bottom + 5.0)], FRAME, 1.0)?;
            let place = (x, bottom + TICK_GAP + TEXT / 2.0);
            canvas.text(&tick.label, place, TEXT, Anchor::Middle, INK)?;
        }
        for tick in &self.panel.y_ticks {
            let y = self.y(tick.at);
            canvas.line(&[(left - 5.0, y), (left, y)], FRAME, 1.0)?;
            canvas.text(&tick.label, (left - TICK_GAP, y), TEXT, Anchor::Right, INK)?;
        }
        let line = TEXT * LEADING;
        let mut y = top - TEXT / 2.0 - 6.0;
        if !self.panel.y_ticks.is_empty() {
            let place = (left - TICK_GAP, y);
            canvas.text(&self.layout.y_label, place, TEXT, Anchor::Right, INK)?;
        }
        let middle = (left + right) / 2.0;
        if !self.panel.share.is_empty() {
            canvas.text(&self.panel.share, (middle, y), TEXT, Anchor::Middle, QUIET)?;
            y -= line;
        }
        for text in self.panel.title.iter().rev() {
            canvas.text(text, (middle, y), TEXT, Anchor::Middle, INK)?;
            y -= line;
        }
        Ok(())
    }
}
