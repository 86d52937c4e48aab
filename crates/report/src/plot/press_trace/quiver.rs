//! The markers from above, with their displacements along the skin as arrows.

use super::table::{Marker, Trace};
use crate::ReportError;
use crate::plot::canvas::{Anchor, Canvas, Point};
use crate::plot::figure::Figure;
use crate::plot::frame::{
    Axes, EDGE, Frame, LINE, SAMPLE_GAP, TEXT, TICK_GAP, WIDTH, Words, outline, widest,
};
use crate::plot::scale::{Scale, Spacing, round_step};
use crate::plot::style::{Colour, FRAME, GRID, INK, Marker as Shape, Style, WHITE};
use palpate_study::label::{spoken_unit, with_unit};

/// Room for the key, and between it and the box.
const KEY: f64 = 240.0;
const GAP: f64 = 30.0;
/// Displacements smaller than this are none.
const LEAST: f64 = 1e-290;
/// Widths of the arrows: the read one lies on the true one.
const TRUE: f64 = 5.0;
const READ: f64 = 2.0;
/// Length of a sample in the key.
const SAMPLE: f64 = 40.0;
/// The strip of shades in the key.
const STRIP: (f64, f64) = (26.0, 190.0);
const SHADES: u32 = 95;

/// The markers and the key.
pub(super) fn figure(trace: &Trace) -> Result<Figure, ReportError> {
    let words = Words {
        name: "quiver".to_owned(),
        title: "Displacement of the markers along the skin".to_owned(),
        subtitle: trace.subtitle(),
        notes: Vec::new(),
    };
    let [x, y] = scales(trace);
    let left = EDGE + widest(&y.ticks(5)) + TICK_GAP + 2.0;
    let side = WIDTH - left - GAP - KEY - EDGE;
    let mut frame = Frame::new(words, WIDTH);
    let top = frame.top + 14.0 + LINE + 6.0;

    // Sized so that neighbours in an even pattern would not touch.
    let apart = side / (trace.markers.len() as f64).sqrt();
    let moves = trace.markers.iter().flat_map(|marker| {
        let read = marker.reading.and_then(|reading| reading.tangential);
        marker.truth.tangential.into_iter().chain(read)
    });
    let longest = moves.map(|[x, y]| libm::hypot(x, y)).fold(0.0, f64::max);
    let normals = trace.markers.iter().map(|marker| marker.truth.normal);
    let quiver = Quiver {
        trace,
        axes: Axes {
            x: &x,
            y: &y,
            corner: (left, top),
            size: (side, side),
        },
        shade: Scale::around(Spacing::Linear, normals),
        radius: (0.17 * apart).clamp(2.0, 11.0),
        longest,
        stretch: (longest > LEAST).then(|| (0.8 * apart).clamp(12.0, 70.0) / longest),
    };
    quiver.draw(&mut frame);
    frame.top = top + side + TICK_GAP + 2.0 * LINE + 10.0;
    frame.finish()
}

/// Scales of the same length around all markers.
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
    })
}

/// The picture with the place of everything.
struct Quiver<'a> {
    trace: &'a Trace,
    axes: Axes<'a>,
    /// Scale of the shade that shows the true normal displacement.
    shade: Scale,
    /// Radius of a marker.
    radius: f64,
    /// Length of the longest displacement along the skin.
    longest: f64,
    /// Pixels per unit of displacement; none if nothing moves along the skin.
    stretch: Option<f64>,
}

impl Quiver<'_> {
    fn draw(&self, frame: &mut Frame) {
        let canvas = &mut frame.canvas;
        self.frame(canvas);
        for marker in &self.trace.markers {
            self.marker(marker, canvas);
        }
        for marker in &self.trace.markers {
            self.arrows(marker, canvas);
        }
        self.key(frame);
    }

    /// A label with the unit of the tables.
    fn in_unit(&self, label: &str) -> String {
        with_unit(label, &spoken_unit(&self.trace.unit))
    }

    fn frame(&self, canvas: &mut Canvas) {
        let Axes { x, y, .. } = self.axes;
        let (left, right, top, bottom) = self.axes.edges();
        let [xs, ys] = [x, y].map(|scale| scale.ticks(5));
        let places = [&xs, &ys].map(|ticks| ticks.iter().map(|tick| tick.at));
        let [across, up] = places;
        self.axes.rule(canvas, across, up, GRID);
        self.axes.outline(canvas);
        for tick in xs {
            self.axes.label_x(canvas, tick.at, &[tick.label]);
        }
        for tick in ys {
            self.axes.label_y(canvas, &tick);
        }
        let x_label = ((left + right) / 2.0, bottom + TICK_GAP + 1.5 * LINE + 8.0);
        canvas.text(&self.in_unit("x"), x_label, TEXT, Anchor::Middle, INK);
        let y_label = (EDGE, top - 6.0 - LINE + TEXT / 2.0);
        canvas.text(&self.in_unit("y"), y_label, TEXT, Anchor::Left, INK);
    }

    /// The marker at rest, shaded by its normal displacement; crossed if it has no reading.
    fn marker(&self, marker: &Marker, canvas: &mut Canvas) {
        let place = self.axes.at(marker.place.into());
        canvas.disc(place, self.radius, FRAME);
        let shade = shade(self.shade.place(marker.truth.normal));
        canvas.disc(place, self.radius - 1.0, shade);
        if marker.reading.is_none() {
            crossed(place, (0.6 * self.radius).max(3.0), canvas);
        }
    }

    fn arrows(&self, marker: &Marker, canvas: &mut Canvas) {
        let read = marker.reading.and_then(|reading| reading.tangential);
        for (moved, colour, wide) in [
            (marker.truth.tangential, true_colour(), TRUE),
            (read, read_colour(), READ),
        ] {
            if let (Some([x, y]), Some(stretch)) = (moved, self.stretch) {
                let from = self.axes.at(marker.place.into());
                arrow(from, (stretch * x, -stretch * y), colour, wide, canvas);
            }
        }
    }

    fn key(&self, frame: &mut Frame) {
        let (_, right, top, _) = self.axes.edges();
        let left = right + GAP;
        let line = |frame: &mut Frame, along: f64, colour: Colour, wide: f64, words: &str| {
            let y = frame.top + TEXT / 2.0;
            arrow((left, y), (along, 0.0), colour, wide, &mut frame.canvas);
            beside(frame, left + along.max(SAMPLE), words);
        };
        frame.top = top;
        if let Some(stretch) = self.stretch {
            frame.heading("along the skin", left, KEY);
            line(frame, SAMPLE, true_colour(), TRUE, "truth");
            if self.trace.reads_tangential {
                line(frame, SAMPLE, read_colour(), READ, "reading");
            }
            let length = round_step(0.8 * self.longest);
            line(
                frame,
                stretch * length,
                INK,
                READ,
                &self.trace.length(length, 1),
            );
        } else {
            frame.heading("nothing along the skin", left, KEY);
        }
        frame.top += 0.8 * LINE;
        frame.heading(&self.in_unit("inward, truth"), left, KEY);
        frame.top += TEXT / 2.0;
        self.strip((left, frame.top), &mut frame.canvas);
        if self.trace.lost() > 0 {
            frame.top += STRIP.1 + 1.2 * LINE - TEXT / 2.0;
            let place = (left + 12.0, frame.top + TEXT / 2.0);
            frame.canvas.disc(place, 11.0, FRAME);
            frame.canvas.disc(place, 10.0, WHITE);
            crossed(place, 6.6, &mut frame.canvas);
            beside(frame, left + 24.0, "no reading");
        }
    }

    /// The shades with their values, from `corner` down.
    fn strip(&self, (left, top): Point, canvas: &mut Canvas) {
        let (right, bottom) = (left + STRIP.0, top + STRIP.1);
        let height = |share: f64| bottom - share * STRIP.1;
        let step = 1.0 / f64::from(SHADES);
        for at in 0..SHADES {
            let low = f64::from(at) * step;
            let (below, above) = (height(low), height(low + step));
            let band = [(left, below), (right, below), (right, above), (left, above)];
            canvas.polygon(&band, shade(low + 0.5 * step));
        }
        outline(canvas, (left, top), STRIP);
        for tick in self.shade.ticks(5) {
            let y = height(self.shade.place(tick.at));
            canvas.line(&[(right, y), (right + 5.0, y)], FRAME, 1.0);
            canvas.text(&tick.label, (right + 10.0, y), TEXT, Anchor::Left, INK);
        }
    }
}

/// Words to the right of a sample that ends at `from`; the next line of the key begins below.
fn beside(frame: &mut Frame, from: f64, words: &str) {
    let place = (from + SAMPLE_GAP, frame.top + TEXT / 2.0);
    frame.canvas.text(words, place, TEXT, Anchor::Left, INK);
    frame.top += LINE;
}

fn true_colour() -> Colour {
    Style::of(0).colour
}

fn read_colour() -> Colour {
    Style::of(1).colour
}

/// Nearly white at 0, a grey on which the arrows are still seen at 1.
fn shade(share: f64) -> Colour {
    let grey = (252.0 - 122.0 * share.clamp(0.0, 1.0)).round() as u8;
    Colour(grey, grey, grey)
}

/// The mark of a marker without a reading.
fn crossed(place: Point, size: f64, canvas: &mut Canvas) {
    canvas.marker(Shape::Cross, place, size, read_colour());
}

/// An arrow; one too short to be seen is not drawn.
fn arrow((x, y): Point, (along, down): Point, colour: Colour, wide: f64, canvas: &mut Canvas) {
    let length = libm::hypot(along, down);
    if length < 1.0 {
        return;
    }
    let head = (2.0 * wide + 6.0).min(0.6 * length);
    let (east, south) = (along / length, down / length);
    let at = |forward: f64, aside: f64| {
        (
            x + forward * east - aside * south,
            y + forward * south + aside * east,
        )
    };
    canvas.line(&[(x, y), at(length - 0.8 * head, 0.0)], colour, wide);
    let half = 0.42 * head.max(wide);
    let tip = [
        at(length, 0.0),
        at(length - head, half),
        at(length - head, -half),
    ];
    canvas.polygon(&tip, colour);
}
