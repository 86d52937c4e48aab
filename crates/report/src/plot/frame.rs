//! The frame that all figures share: title, subtitle, key, notes, and axes around what is drawn.

use super::canvas::{Anchor, Canvas, Point};
use super::figure::Figure;
use super::lettering::{width, wrap};
use super::scale::{Scale, Tick};
use super::style::{Colour, FRAME, INK, QUIET};
use crate::ReportError;

/// Size of the title.
const TITLE: f64 = 25.0;
/// Size of all other text.
pub(crate) const TEXT: f64 = 18.0;
/// Distance between lines of text, in sizes of the text.
const LEADING: f64 = 1.35;
/// Distance between lines of text, pixels.
pub(crate) const LINE: f64 = TEXT * LEADING;
/// Margin around the picture.
pub(crate) const EDGE: f64 = 22.0;
/// Gap between a panel and the labels of its ticks, pixels.
pub(crate) const TICK_GAP: f64 = 10.0;
/// Gap between a sample in a key and its words, pixels.
pub(crate) const SAMPLE_GAP: f64 = 8.0;
/// Gap between entries of a key beside each other, pixels.
const ENTRY_GAP: f64 = 26.0;
/// Least width of figures whose content may be of any.
pub(crate) const WIDTH: f64 = 960.0;

/// Words around a figure.
#[derive(Debug, Clone, Default)]
pub(crate) struct Words {
    /// File stem.
    pub(crate) name: String,
    pub(crate) title: String,
    /// Sample size and what is held fixed.
    pub(crate) subtitle: String,
    /// Notes on what is not drawn, with reasons.
    pub(crate) notes: Vec<String>,
}

/// A figure while it is drawn.
pub(crate) struct Frame {
    pub(crate) canvas: Canvas,
    pub(crate) width: f64,
    /// How far down it reaches.
    pub(crate) top: f64,
    words: Words,
}

impl Frame {
    /// A frame of this width, with its title and subtitle.
    pub(crate) fn new(words: Words, width: f64) -> Self {
        let mut frame = Self {
            canvas: Canvas::default(),
            width,
            top: EDGE,
            words,
        };
        let Words {
            title, subtitle, ..
        } = frame.words.clone();
        frame.paragraph(&title, TITLE, INK);
        frame.paragraph(&subtitle, TEXT, QUIET);
        frame
    }

    /// Text in as many lines as it needs.
    fn paragraph(&mut self, text: &str, size: f64, colour: Colour) {
        for line in wrap(text, size, self.width - 2.0 * EDGE) {
            let place = (EDGE, self.top + size / 2.0);
            self.canvas.text(&line, place, size, Anchor::Left, colour);
            self.top += size * LEADING;
        }
    }

    /// Text in as many lines as it needs to the right of `left`, at most `limit` wide.
    pub(crate) fn heading(&mut self, text: &str, left: f64, limit: f64) {
        for line in wrap(text, TEXT, limit) {
            let place = (left, self.top + TEXT / 2.0);
            self.canvas.text(&line, place, TEXT, Anchor::Left, INK);
            self.top += LINE;
        }
    }

    /// Samples of a width with their words, beside each other in as many lines as they need; `draw` draws one from the
    /// left end of its middle height.
    pub(crate) fn key<S>(
        &mut self,
        sample: f64,
        entries: &[(S, String)],
        draw: impl Fn(&mut Canvas, Point, &S),
    ) {
        self.top += 12.0;
        let mut x = EDGE;
        for (kind, text) in entries {
            let wide = sample + SAMPLE_GAP + width(text, TEXT);
            if x > EDGE && x + wide > self.width - EDGE {
                (x, self.top) = (EDGE, self.top + LINE + 4.0);
            }
            let y = self.top + TEXT / 2.0;
            draw(&mut self.canvas, (x, y), kind);
            let place = (x + sample + SAMPLE_GAP, y);
            self.canvas.text(text, place, TEXT, Anchor::Left, INK);
            x += wide + ENTRY_GAP;
        }
        if !entries.is_empty() {
            self.top += TEXT / 2.0 + 1.1 * LINE;
        }
    }

    /// The figure, with its notes at the end.
    pub(crate) fn finish(mut self) -> Result<Figure, ReportError> {
        let notes = std::mem::take(&mut self.words.notes);
        if !notes.is_empty() {
            self.top += 10.0;
        }
        notes
            .iter()
            .for_each(|note| self.paragraph(note, TEXT, QUIET));
        let size = (self.width.ceil(), (self.top + EDGE - 6.0).ceil());
        let Words { name, title, .. } = self.words;
        Figure::new(name, title, self.canvas, size)
    }
}

/// Axes around a panel in its place.
#[derive(Clone, Copy)]
pub(crate) struct Axes<'a> {
    pub(crate) x: &'a Scale,
    pub(crate) y: &'a Scale,
    /// Upper left corner.
    pub(crate) corner: Point,
    pub(crate) size: (f64, f64),
}

/// Draws an interval from one height to another, with caps at those ends that have one.
pub(crate) fn bar(canvas: &mut Canvas, x: f64, ends: [f64; 2], capped: [bool; 2], colour: Colour) {
    const WIDTH: f64 = 1.5;
    const HALF_CAP: f64 = 4.0;
    canvas.line(&ends.map(|end| (x, end)), colour, WIDTH);
    for (end, _) in ends.into_iter().zip(capped).filter(|(_, capped)| *capped) {
        canvas.line(&[(x - HALF_CAP, end), (x + HALF_CAP, end)], colour, WIDTH);
    }
}

impl Axes<'_> {
    /// Place across of a value of x.
    pub(crate) fn across(&self, x: f64) -> f64 {
        self.corner.0 + self.x.place(x) * self.size.0
    }

    /// Place down of a value of y.
    pub(crate) fn down(&self, y: f64) -> f64 {
        self.corner.1 + (1.0 - self.y.place(y)) * self.size.1
    }

    pub(crate) fn at(&self, (x, y): (f64, f64)) -> Point {
        (self.across(x), self.down(y))
    }

    /// Left, right, top and bottom.
    pub(crate) fn edges(&self) -> (f64, f64, f64, f64) {
        let (left, top) = self.corner;
        (left, left + self.size.0, top, top + self.size.1)
    }

    /// Ends of an interval up at a value of x, the lower first, as far as it lies within the panel.
    pub(crate) fn upright(&self, x: f64, ends: [f64; 2]) -> [Point; 2] {
        let (_, _, top, bottom) = self.edges();
        ends.map(|end| (self.across(x), self.down(end).clamp(top, bottom)))
    }

    /// Draws an interval up at a value of x, unless it is no longer than `hidden`, such as a marker that covers it.
    pub(crate) fn bar(
        &self,
        canvas: &mut Canvas,
        x: f64,
        ends: [f64; 2],
        hidden: f64,
        colour: Colour,
    ) {
        let (_, _, top, bottom) = self.edges();
        let [(x, low), (_, high)] = self.upright(x, ends);
        if low - high > hidden {
            let inside = [low, high].map(|end| end > top && end < bottom);
            bar(canvas, x, [low, high], inside, colour);
        }
    }

    /// Lines up at values of x, and across at values of y.
    pub(crate) fn rule(
        &self,
        canvas: &mut Canvas,
        xs: impl IntoIterator<Item = f64>,
        ys: impl IntoIterator<Item = f64>,
        colour: Colour,
    ) {
        let (left, right, top, bottom) = self.edges();
        for x in xs.into_iter().map(|x| self.across(x)) {
            canvas.line(&[(x, top), (x, bottom)], colour, 1.0);
        }
        for y in ys.into_iter().map(|y| self.down(y)) {
            canvas.line(&[(left, y), (right, y)], colour, 1.0);
        }
    }

    pub(crate) fn outline(&self, canvas: &mut Canvas) {
        outline(canvas, self.corner, self.size);
    }

    /// Lines of a label below the tick at a value of x.
    pub(crate) fn label_x(&self, canvas: &mut Canvas, at: f64, lines: &[String]) {
        let (x, bottom) = (self.across(at), self.corner.1 + self.size.1);
        for (row, line) in lines.iter().enumerate() {
            let y = bottom + TICK_GAP + TEXT / 2.0 + row as f64 * LINE;
            canvas.text(line, (x, y), TEXT, Anchor::Middle, INK);
        }
    }

    /// The label to the left of a tick of y.
    pub(crate) fn label_y(&self, canvas: &mut Canvas, tick: &Tick) {
        let place = (self.corner.0 - TICK_GAP, self.down(tick.at));
        canvas.text(&tick.label, place, TEXT, Anchor::Right, INK);
    }
}

/// The outline of a box.
pub(crate) fn outline(canvas: &mut Canvas, (left, top): Point, (wide, high): (f64, f64)) {
    let (right, bottom) = (left + wide, top + high);
    let corners = [
        (left, top),
        (right, top),
        (right, bottom),
        (left, bottom),
        (left, top),
    ];
    canvas.line(&corners, FRAME, 1.0);
}

/// Width of the widest label.
pub(crate) fn widest(ticks: &[Tick]) -> f64 {
    let widths = ticks.iter().map(|tick| width(&tick.label, TEXT));
    widths.fold(0.0, f64::max)
}
