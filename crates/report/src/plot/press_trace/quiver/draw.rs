//! Drawing the markers and the key.

use super::Quiver;
use crate::plot::canvas::{Anchor, Canvas, Drawn, Point};
use crate::plot::draw::{FRAME, GRID, INK, QUIET, WHITE, paragraph};
use crate::plot::layout::{EDGE, LEADING, TEXT, TICK_GAP, TITLE};
use crate::plot::lettering::wrap;
use crate::plot::press_trace::table::Marker;
use crate::plot::style::{Marker as Shape, Style};
use crate::words;
use plotters::prelude::{DrawingBackend, RGBColor};

/// Widths of the arrows: the read one lies on the true one.
const TRUE: f64 = 5.0;
const READ: f64 = 2.0;
/// Length of a sample in the key.
const SAMPLE: f64 = 40.0;
/// The strip of shades in the key.
const STRIP: (f64, f64) = (26.0, 190.0);
const SHADES: u32 = 95;

impl Quiver {
    /// Draws the picture.
    pub(crate) fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        canvas.fill(WHITE)?;
        canvas.text(
            &self.title,
            (EDGE, EDGE + TITLE / 2.0),
            TITLE,
            Anchor::Left,
            INK,
        )?;
        paragraph(canvas, &self.subtitle, EDGE + TITLE * LEADING, TEXT, QUIET)?;
        self.frame(canvas)?;
        for marker in &self.trace.markers {
            self.marker(marker, canvas)?;
        }
        for marker in &self.trace.markers {
            self.arrows(marker, canvas)?;
        }
        self.key(canvas)
    }

    fn at(&self, [x, y]: [f64; 2]) -> Point {
        (
            self.corner.0 + self.x.place(x) * self.side,
            self.corner.1 + (1.0 - self.y.place(y)) * self.side,
        )
    }

    fn frame<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        let ((left, top), side) = (self.corner, self.side);
        let (right, bottom) = (left + side, top + side);
        for tick in self.x.ticks(5) {
            let x = left + self.x.place(tick.at) * side;
            canvas.line(&[(x, top), (x, bottom)], GRID, 1.0)?;
            let below = (x, bottom + TICK_GAP + TEXT / 2.0);
            canvas.text(&tick.label, below, TEXT, Anchor::Middle, INK)?;
        }
        for tick in self.y.ticks(5) {
            let y = top + (1.0 - self.y.place(tick.at)) * side;
            canvas.line(&[(left, y), (right, y)], GRID, 1.0)?;
            canvas.text(&tick.label, (left - TICK_GAP, y), TEXT, Anchor::Right, INK)?;
        }
        let around = [
            (left, top),
            (right, top),
            (right, bottom),
            (left, bottom),
            (left, top),
        ];
        canvas.line(&around, FRAME, 1.0)?;
        let line = TEXT * LEADING;
        let x_label = (left + side / 2.0, bottom + TICK_GAP + 1.5 * line + 8.0);
        canvas.text(&self.in_unit("x"), x_label, TEXT, Anchor::Middle, INK)?;
        let y_label = (EDGE, top - 6.0 - line + TEXT / 2.0);
        canvas.text(&self.in_unit("y"), y_label, TEXT, Anchor::Left, INK)
    }

    /// The marker at rest, shaded by its normal displacement; crossed if it has no reading.
    fn marker<B: DrawingBackend>(&self, marker: &Marker, canvas: &Canvas<B>) -> Drawn {
        let place = self.at(marker.place);
        canvas.disc(place, self.radius, FRAME)?;
        let shade = shade(self.shade.place(marker.truth.normal));
        canvas.disc(place, self.radius - 1.0, shade)?;
        match marker.reading {
            Some(_) => Ok(()),
            None => crossed(place, (0.6 * self.radius).max(3.0), canvas),
        }
    }

    fn arrows<B: DrawingBackend>(&self, marker: &Marker, canvas: &Canvas<B>) -> Drawn {
        let read = marker.reading.and_then(|reading| reading.tangential);
        for (moved, colour, wide) in [
            (marker.truth.tangential, true_colour(), TRUE),
            (read, read_colour(), READ),
        ] {
            if let (Some([x, y]), Some(stretch)) = (moved, self.stretch) {
                let from = self.at(marker.place);
                arrow(from, (stretch * x, -stretch * y), colour, wide, canvas)?;
            }
        }
        Ok(())
    }

    fn key<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        let left = self.corner.0 + self.side + super::GAP;
        let line = TEXT * LEADING;
        let mut y = self.corner.1 + TEXT / 2.0;
        let heading = |text: String, y: &mut f64| -> Drawn {
            for part in wrap(&text, TEXT, super::KEY) {
                canvas.text(&part, (left, *y), TEXT, Anchor::Left, INK)?;
                *y += line;
            }
            Ok(())
        };
        let beside = |text: &str, from: f64, y: f64| {
            canvas.text(text, (left + from + 8.0, y), TEXT, Anchor::Left, INK)
        };
        if let Some(stretch) = self.stretch {
            heading("along the skin".to_owned(), &mut y)?;
            arrow((left, y), (SAMPLE, 0.0), true_colour(), TRUE, canvas)?;
            beside("truth", SAMPLE, y)?;
            y += line;
            if self.trace.reads_tangential {
                arrow((left, y), (SAMPLE, 0.0), read_colour(), READ, canvas)?;
                beside("reading", SAMPLE, y)?;
                y += line;
            }
            let long = stretch * self.sample;
            arrow((left, y), (long, 0.0), INK, READ, canvas)?;
            let unit = words::unit(&self.trace.unit);
            let length = format!("{} {unit}", words::significant(self.sample, 1));
            beside(length.trim_end(), long.max(SAMPLE), y)?;
        } else {
            heading("nothing along the skin".to_owned(), &mut y)?;
            y -= line;
        }
        y += 1.8 * line;
        heading(self.in_unit("inward, truth"), &mut y)?;
        self.strip((left, y), canvas)?;
        if self.trace.lost() > 0 {
            y += STRIP.1 + 1.2 * line;
            canvas.disc((left + 12.0, y), 11.0, FRAME)?;
            canvas.disc((left + 12.0, y), 10.0, WHITE)?;
            crossed((left + 12.0, y), 6.6, canvas)?;
            beside("no reading", 24.0, y)?;
        }
        Ok(())
    }

    /// The shades with their values, from `corner` down.
    fn strip<B: DrawingBackend>(&self, (left, top): Point, canvas: &Canvas<B>) -> Drawn {
        let (right, bottom) = (left + STRIP.0, top + STRIP.1);
        let height = |share: f64| bottom - share * STRIP.1;
        let step = 1.0 / f64::from(SHADES);
        for at in 0..SHADES {
            let low = f64::from(at) * step;
            let band = [
                (left, height(low)),
                (right, height(low)),
                (right, height(low + step)),
                (left, height(low + step)),
            ];
            canvas.polygon(&band, shade(low + 0.5 * step))?;
        }
        let around = [
            (left, top),
            (right, top),
            (right, bottom),
            (left, bottom),
            (left, top),
        ];
        canvas.line(&around, FRAME, 1.0)?;
        for tick in self.shade.ticks(5) {
            let y = height(self.shade.place(tick.at));
            canvas.line(&[(right, y), (right + 5.0, y)], FRAME, 1.0)?;
            canvas.text(&tick.label, (right + 10.0, y), TEXT, Anchor::Left, INK)?;
        }
        Ok(())
    }
}

fn true_colour() -> RGBColor {
    Style::of(0).colour
}

fn read_colour() -> RGBColor {
    Style::of(1).colour
}

/// Nearly white at 0, a grey on which the arrows are still seen at 1.
fn shade(share: f64) -> RGBColor {
    let grey = (252.0 - 122.0 * share.clamp(0.0, 1.0)).round() as u8;
    RGBColor(grey, grey, grey)
}

/// The mark of a marker without a reading.
fn crossed<B: DrawingBackend>(place: Point, size: f64, canvas: &Canvas<B>) -> Drawn {
    canvas.marker(Shape::Cross, place, size, read_colour())
}

/// An arrow; one too short to be seen is not drawn.
fn arrow<B: DrawingBackend>(
    (x, y): Point,
    (along, down): Point,
    colour: RGBColor,
    wide: f64,
    canvas: &Canvas<B>,
) -> Drawn {
    let length = libm::hypot(along, down);
    if length < 1.0 {
        return Ok(());
    }
    let head = (2.0 * wide + 6.0).min(0.6 * length);
    let (east, south) = (along / length, down / length);
    let at = |forward: f64, aside: f64| {
        (
            x + forward * east - aside * south,
            y + forward * south + aside * east,
        )
    };
    canvas.line(&[(x, y), at(length - 0.8 * head, 0.0)], colour, wide)?;
    let half = 0.42 * head.max(wide);
    let tip = [
        at(length, 0.0),
        at(length - head, half),
        at(length - head, -half),
    ];
    canvas.polygon(&tip, colour)
}
