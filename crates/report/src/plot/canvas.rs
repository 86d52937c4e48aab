//! Lines, shapes and text in pixels of the finished picture, and the SVG made of them.

use super::lettering;
use super::style::{Colour, Marker, WHITE};
use plotters_backend::text_anchor::{HPos, Pos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontFamily,
};
use plotters_svg::SVGBackend;
use std::convert::Infallible;
use std::io;

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
    colour: Colour,
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

/// Shapes, from the lowest to the topmost.
#[derive(Default)]
pub(crate) struct Canvas {
    shapes: Vec<Shape>,
}

impl Canvas {
    fn push(&mut self, form: Form, colour: Colour) {
        let title = String::new();
        self.shapes.push(Shape {
            form,
            colour,
            title,
        });
    }

    /// Adds to the topmost shape words that a viewer shows when pointed at it.
    pub(crate) fn title(&mut self, words: &str) {
        if let Some(shape) = self.shapes.last_mut() {
            words.clone_into(&mut shape.title);
        }
    }

    /// A line through `points`, `width` pixels wide.
    pub(crate) fn line(&mut self, points: &[Point], colour: Colour, width: f64) {
        self.push(Form::Line(points.to_vec(), width), colour);
    }

    /// A dashed line through `points`.
    pub(crate) fn dashes(&mut self, points: &[Point], colour: Colour, width: f64) {
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
    pub(crate) fn polygon(&mut self, points: &[Point], colour: Colour) {
        self.push(Form::Polygon(points.to_vec()), colour);
    }

    /// A filled circle.
    pub(crate) fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        self.push(Form::Disc(centre, radius), colour);
    }

    /// A line of text whose middle height is at `place`.
    pub(crate) fn text(
        &mut self,
        text: &str,
        place: Point,
        size: f64,
        anchor: Anchor,
        colour: Colour,
    ) {
        self.push(Form::Text(text.to_owned(), place, size, anchor), colour);
    }

    /// A marker of about `size` pixels in radius on a white rim.
    pub(crate) fn marker(&mut self, marker: Marker, place: Point, size: f64, colour: Colour) {
        self.marker_shape(marker, place, size, 1.5, WHITE);
        self.marker_shape(marker, place, size, 0.0, colour);
        if marker == Marker::Ring {
            self.disc(place, 0.5 * size, WHITE);
        }
    }

    /// The outline of such a marker, white within unless it is never open.
    pub(crate) fn open_marker(&mut self, marker: Marker, place: Point, size: f64, colour: Colour) {
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
        colour: Colour,
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
    fn bars(&mut self, (x, y): Point, size: f64, grow: f64, turn: f64, colour: Colour) {
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
            let mut backend = SVGBackend::with_string(&mut text, units);
            let corner = (units.0 as i32, units.1 as i32);
            let drawn = backend
                .draw_rect((0, 0), corner, &Pen::filling(WHITE), true)
                .and_then(|()| {
                    self.shapes
                        .iter()
                        .try_for_each(|shape| shape.draw(&mut backend))
                })
                .and_then(|()| backend.present());
            drawn.map_err(|error| error.to_string())?;
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

type Drawn = Result<(), DrawingErrorKind<io::Error>>;

impl Shape {
    fn draw(&self, backend: &mut SVGBackend<'_>) -> Drawn {
        let pen = Pen::filling(self.colour);
        let path = |points: &[Point]| points.iter().map(at).collect::<Vec<_>>();
        match &self.form {
            Form::Line(points, width) => {
                let width = units(*width).max(1) as u32;
                backend.draw_path(path(points), &Pen { width, ..pen })
            }
            Form::Polygon(points) => backend.fill_polygon(path(points), &pen),
            Form::Disc(centre, radius) => {
                backend.draw_circle(at(centre), units(*radius).max(0) as u32, &pen, true)
            }
            Form::Text(text, (x, y), size, anchor) => {
                let place = at(&(*x, y + SINK * size));
                let (size, anchor) = (*size, *anchor);
                backend.draw_text(text, &Letters { pen, size, anchor }, place)
            }
        }
    }
}

/// Units of the backend for a length in pixels.
fn units(length: f64) -> i32 {
    (length * f64::from(DETAIL)).round() as i32
}

fn at((x, y): &Point) -> BackendCoord {
    (units(*x), units(*y))
}

/// Colour and width of what is drawn, in units of the backend.
#[derive(Clone, Copy)]
struct Pen {
    colour: Colour,
    width: u32,
}

impl Pen {
    fn filling(colour: Colour) -> Self {
        Self { colour, width: 1 }
    }
}

impl BackendStyle for Pen {
    fn color(&self) -> BackendColor {
        let Colour(red, green, blue) = self.colour;
        BackendColor {
            alpha: 1.0,
            rgb: (red, green, blue),
        }
    }

    fn stroke_width(&self) -> u32 {
        self.width
    }
}

/// Style of a line of text.
struct Letters {
    pen: Pen,
    /// Size in pixels.
    size: f64,
    anchor: Anchor,
}

impl BackendTextStyle for Letters {
    type FontError = Infallible;

    fn color(&self) -> BackendColor {
        self.pen.color()
    }

    fn size(&self) -> f64 {
        self.size * EM * f64::from(DETAIL)
    }

    fn anchor(&self) -> Pos {
        let horizontal = match self.anchor {
            Anchor::Left => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        Pos::new(horizontal, VPos::Center)
    }

    fn family(&self) -> FontFamily<'_> {
        FontFamily::SansSerif
    }

    fn layout_box(&self, text: &str) -> Result<(BackendCoord, BackendCoord), Infallible> {
        Ok(((0, 0), at(&(lettering::width(text, self.size), self.size))))
    }

    /// The backend writes text as text, so that there are no pixels to draw.
    fn draw<E, F: FnMut(i32, i32, BackendColor) -> Result<(), E>>(
        &self,
        _: &str,
        _: BackendCoord,
        _: F,
    ) -> Result<Result<(), E>, Infallible> {
        Ok(Ok(()))
    }
}

/// A text as it stands in an SVG.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
