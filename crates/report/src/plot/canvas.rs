//! Lines, shapes and text in pixels of the finished picture, and the SVG made of them.

use super::style::{Marker, WHITE};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Backends count in whole units; a pixel of the picture has this many, so that curves and text keep their shape.
const DETAIL: u32 = 3;
/// The SVG backend divides a font's size by this to get the size of its em.
const EM: f64 = 1.24;
/// Shift of text downward, in ems: the SVG backend centres small letters, and capitals and digits are to be centred.
const SINK: f64 = 0.09;

/// Place in the picture, from its upper left corner.
pub(crate) type Point = (f64, f64);

/// Point of a text that stands at its place.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Anchor {
    Left,
    Middle,
    Right,
}

/// Shape of one colour.
struct Shape {
    form: Form,
    colour: RGBColor,
    /// Words that a viewer shows when pointed at it; may be empty.
    title: String,
}

enum Form {
    /// Line and its width.
    Line(Vec<Point>, f64),
    Polygon(Vec<Point>),
    /// Centre and radius.
    Disc(Point, f64),
    /// Line of text with its place, size and anchor.
    Text(String, Point, f64, Anchor),
}

/// What is drawn, from the lowest to the topmost.
#[derive(Default)]
pub(crate) struct Canvas {
    shapes: Vec<Shape>,
}

impl Canvas {
    fn push(&mut self, form: Form, colour: RGBColor) {
        let title = String::new();
        self.shapes.push(Shape {
            form,
            colour,
            title,
        });
    }

    /// Gives the topmost shape words that a viewer shows when pointed at it.
    pub(crate) fn title(&mut self, words: &str) {
        if let Some(shape) = self.shapes.last_mut() {
            words.clone_into(&mut shape.title);
        }
    }

    /// A line through `points`, `width` pixels wide.
    pub(crate) fn line(&mut self, points: &[Point], colour: RGBColor, width: f64) {
        self.push(Form::Line(points.to_vec(), width), colour);
    }

    /// A dashed line through `points`.
    pub(crate) fn dashes(&mut self, points: &[Point], colour: RGBColor, width: f64) {
        const ON: f64 = 8.0;
        const PERIOD: f64 = 13.0;
        let mut done = 0.0;
        for pair in points.windows(2) {
            let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
            let length = libm::hypot(x1 - x0, y1 - y0);
            let along = |s: f64| (x0 + (x1 - x0) * s / length, y0 + (y1 - y0) * s / length);
            let mut dash = -(done % PERIOD);
            while dash < length {
                let (from, to) = (dash.max(0.0), (dash + ON).min(length));
                if to > from {
                    self.line(&[along(from), along(to)], colour, width);
                }
                dash += PERIOD;
            }
            done += length;
        }
    }

    /// A filled polygon.
    pub(crate) fn polygon(&mut self, points: &[Point], colour: RGBColor) {
        self.push(Form::Polygon(points.to_vec()), colour);
    }

    /// A filled circle.
    pub(crate) fn disc(&mut self, centre: Point, radius: f64, colour: RGBColor) {
        self.push(Form::Disc(centre, radius), colour);
    }

    /// One line of text whose middle height is at `place`.
    pub(crate) fn text(
        &mut self,
        text: &str,
        place: Point,
        size: f64,
        anchor: Anchor,
        colour: RGBColor,
    ) {
        self.push(Form::Text(text.to_owned(), place, size, anchor), colour);
    }

    /// A marker of about `size` pixels in radius on a white rim.
    pub(crate) fn marker(&mut self, marker: Marker, place: Point, size: f64, colour: RGBColor) {
        self.marker_shape(marker, place, size, 1.5, WHITE);
        self.marker_shape(marker, place, size, 0.0, colour);
        if marker == Marker::Ring {
            self.disc(place, 0.5 * size, WHITE);
        }
    }

    /// The outline of such a marker, white within unless it is never open.
    pub(crate) fn open_marker(
        &mut self,
        marker: Marker,
        place: Point,
        size: f64,
        colour: RGBColor,
    ) {
        self.marker(marker, place, size, colour);
        if !matches!(marker, Marker::Dot | Marker::Dash) {
            self.marker_shape(marker, place, 0.55 * size, 0.0, WHITE);
        }
    }

    /// The shape of a marker of about `size + grow` pixels in radius, whose bars are those of `size`, as much wider.
    fn marker_shape(
        &mut self,
        marker: Marker,
        (x, y): Point,
        size: f64,
        grow: f64,
        colour: RGBColor,
    ) {
        let r = size + grow;
        let scaled = |corner: &Point| (x + r * corner.0, y + r * corner.1);
        let corners: &[Point] = match marker {
            Marker::Circle | Marker::Ring => return self.disc((x, y), r, colour),
            Marker::Dot => return self.disc((x, y), 0.55 * size + grow, colour),
            Marker::Plus => return self.bars((x, y), size, grow, 0.0, colour),
            Marker::Cross => {
                let turn = std::f64::consts::FRAC_PI_4;
                return self.bars((x, y), size, grow, turn, colour);
            }
            Marker::Dash => {
                let (wide, high) = (1.9 * size, 0.25 * size + grow);
                let (left, right, top, bottom) = (x - wide, x + wide, y - high, y + high);
                let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
                return self.polygon(&corners, colour);
            }
            Marker::Square => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            Marker::Up => &[(-1.1, 0.85), (1.1, 0.85), (0.0, -1.15)],
            Marker::Down => &[(-1.1, -0.85), (1.1, -0.85), (0.0, 1.15)],
            Marker::Diamond => &[(-1.2, 0.0), (0.0, -1.2), (1.2, 0.0), (0.0, 1.2)],
        };
        self.polygon(&corners.iter().map(scaled).collect::<Vec<_>>(), colour);
    }

    /// Two bars across each other, turned by an angle.
    fn bars(&mut self, (x, y): Point, size: f64, grow: f64, turn: f64, colour: RGBColor) {
        let (r, half) = (1.15 * (size + grow), 0.35 * size + grow);
        let (sine, cosine) = libm::sincos(turn);
        for (c, s) in [(cosine, sine), (-sine, cosine)] {
            let corner = |(a, b): Point| (x + a * c - b * s, y + a * s + b * c);
            let bar = [(-r, -half), (r, -half), (r, half), (-r, half)];
            self.polygon(&bar.map(corner), colour);
        }
    }

    /// SVG text of the picture on a white ground, with a label for readers of screens; or the message of the backend.
    pub(crate) fn svg(&self, (width, height): (f64, f64), label: &str) -> Result<String, String> {
        let (width, height) = (width as u32, height as u32);
        let units = (width * DETAIL, height * DETAIL);
        let mut text = String::new();
        {
            let area = SVGBackend::with_string(&mut text, units).into_drawing_area();
            area.fill(&WHITE).map_err(|error| error.to_string())?;
            let mut shapes = self.shapes.iter();
            shapes.try_for_each(|shape| shape.draw(&area))?;
            area.present().map_err(|error| error.to_string())?;
        }
        // The backend knows one size only: give the picture its own, keep the units of its content, and name it.
        let backend = format!("width=\"{}\" height=\"{}\" viewBox", units.0, units.1);
        let label = escaped(label);
        let own = format!(
            "width=\"{width}\" height=\"{height}\" role=\"img\" aria-label=\"{label}\" viewBox"
        );
        Ok(self.titled(&text.replacen(&backend, &own, 1)))
    }

    /// The backend's SVG, of an element for the ground and one for each shape, with the titles of the shapes.
    fn titled(&self, svg: &str) -> String {
        let mut titles = std::iter::once("").chain(self.shapes.iter().map(|it| it.title.as_str()));
        let mut titled = String::with_capacity(svg.len());
        for line in svg.lines() {
            let element = line
                .strip_prefix('<')
                .filter(|rest| !rest.starts_with(['/', '?', '!']));
            let name = element.map(|rest| rest.split([' ', '>']).next().unwrap_or_default());
            let title = name
                .filter(|name| *name != "svg")
                .and_then(|_| titles.next());
            match (line.strip_suffix("/>"), name, title) {
                (Some(open), Some(name), Some(title)) if !title.is_empty() => {
                    titled += &format!("{open}><title>{}</title></{name}>\n", escaped(title));
                }
                _ => titled += &format!("{line}\n"),
            }
        }
        titled
    }
}

impl Shape {
    fn draw(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), String> {
        let unit = |value: f64| (value * f64::from(DETAIL)).round() as i32;
        let at = |place: &Point| (unit(place.0), unit(place.1));
        let path = |points: &[Point]| points.iter().map(at).collect::<Vec<_>>();
        let colour = self.colour;
        let drawn = match &self.form {
            Form::Line(points, width) => {
                let style = colour.stroke_width(unit(*width).max(1) as u32);
                area.draw(&PathElement::new(path(points), style))
            }
            Form::Polygon(points) => area.draw(&Polygon::new(path(points), colour.filled())),
            Form::Disc(centre, radius) => {
                area.draw(&Circle::new(at(centre), unit(*radius), colour.filled()))
            }
            Form::Text(text, (x, y), size, anchor) => {
                let horizontal = match anchor {
                    Anchor::Left => HPos::Left,
                    Anchor::Middle => HPos::Center,
                    Anchor::Right => HPos::Right,
                };
                let font = ("sans-serif", size * EM * f64::from(DETAIL)).into_font();
                let style = TextStyle::from(font)
                    .color(&colour)
                    .pos(Pos::new(horizontal, VPos::Center));
                area.draw_text(text, &style, at(&(*x, y + SINK * size)))
            }
        };
        drawn.map_err(|error| error.to_string())
    }
}

/// A text as it stands in an SVG.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
