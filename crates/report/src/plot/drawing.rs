//! A figure, and the drawing from which its SVG and its PNG are made.

use super::style::{Colour, WHITE};
use crate::ReportError;
use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontFamily, TextStyle};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind,
};
use std::convert::Infallible;
use std::io;

/// Number of drawing units per pixel. The plotters library uses integer coordinates, and whole pixels would be too
/// coarse.
const DETAIL: u32 = 3;
/// Ratio of a font size to the em (the nominal height of the font) in the SVG backend of the plotters library.
const EM: f64 = 1.24;
/// Distance by which text is moved down so that capital letters and digits are centred vertically, in ems (an em is the
/// nominal height of the font). Without it, the SVG backend centres lower-case letters.
const SINK: f64 = 0.09;
/// Distance between lines of text, as a multiple of the font size.
pub(crate) const LEADING: f64 = 1.35;
/// Height of lower-case letters without ascenders, such as x, in ems (the nominal height of the font).
#[cfg(feature = "png")]
const X_HEIGHT: f64 = 0.52;
/// Limit of the memory for drawing one image, bytes.
#[cfg(feature = "png")]
const MAX_BYTES: u64 = 1 << 31;

/// A figure with its name, its title and its image.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of the figure's files, without extension.
    pub name: String,
    /// Title, which is also drawn in the image.
    pub title: String,
    /// The image as SVG. Its texts are stored as texts, so a viewer displays them in its own sans-serif font.
    pub svg: String,
    drawing: Drawing,
}

impl Figure {
    pub(crate) fn new(name: String, title: String, drawing: Drawing) -> Result<Self, ReportError> {
        let svg = drawing.svg(&title).map_err(|error| ReportError::Draw {
            path: format!("{name}.svg").into(),
            message: error.to_string(),
        })?;
        Ok(Self {
            name,
            title,
            svg,
            drawing,
        })
    }

    pub(crate) fn width(&self) -> f64 {
        f64::from(self.drawing.size.0.div_ceil(DETAIL))
    }

    /// The image as PNG, with the built-in fonts. It has the same size in pixels as the SVG.
    ///
    /// # Errors
    /// [`ReportError`] if the image is too large.
    #[cfg(feature = "png")]
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        self.drawing.png().map_err(|message| ReportError::Draw {
            path: format!("{}.png", self.name).into(),
            message,
        })
    }
}

/// The shapes of a figure, from bottom to top.
///
/// `Drawing` is a backend of the plotters library that only records shapes. The SVG and the PNG are made later from the
/// recorded shapes. So the height of a figure can depend on its content, and a PNG is made only on request.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drawing {
    pub(crate) size: (u32, u32),
    shapes: Vec<Shape>,
}

#[derive(Debug, Clone, PartialEq)]
struct Shape {
    form: Form,
    colour: Colour,
    title: String,
}

#[derive(Debug, Clone, PartialEq)]
enum Form {
    Line(Vec<BackendCoord>, u32),
    Polygon(Vec<BackendCoord>),
    Disc(BackendCoord, u32),
    /// A line of text, its anchor point, the em (nominal height) of its font, and the share of the text's width that is
    /// to the left of the anchor. Vertically, the anchor is in the middle of the text.
    Text(String, BackendCoord, f64, f64),
}

type Drawn<E> = Result<(), DrawingErrorKind<E>>;

impl Drawing {
    /// A drawing without shapes. Its height is set later.
    pub(crate) fn new(width: i32) -> Self {
        Self {
            size: (width.unsigned_abs(), 1 << 24),
            shapes: Vec::new(),
        }
    }

    /// Sets the tooltip of the shape that was drawn last.
    pub(crate) fn title(&mut self, words: &str) {
        if let Some(shape) = self.shapes.last_mut() {
            words.clone_into(&mut shape.title);
        }
    }

    fn push(&mut self, form: Form, colour: BackendColor) -> Drawn<Infallible> {
        let (red, green, blue) = colour.rgb;
        if colour.alpha > 0.0 {
            self.shapes.push(Shape {
                form,
                colour: Colour(red, green, blue),
                title: String::new(),
            });
        }
        Ok(())
    }

    fn svg(&self, label: &str) -> Result<String, DrawingErrorKind<io::Error>> {
        let mut text = String::new();
        {
            let mut backend = SVGBackend::with_string(&mut text, self.size);
            let corner = (self.size.0 as i32, self.size.1 as i32);
            backend.draw_rect((0, 0), corner, &WHITE, true)?;
            for Shape { form, colour, .. } in &self.shapes {
                match form {
                    Form::Line(points, width) => {
                        backend.draw_path(points.clone(), &Color::stroke_width(colour, *width))?;
                    }
                    Form::Polygon(corners) => backend.fill_polygon(corners.clone(), colour)?,
                    Form::Disc(centre, radius) => {
                        backend.draw_circle(*centre, *radius, colour, true)?;
                    }
                    Form::Text(letters, (x, y), em, before) => {
                        let horizontal = match before {
                            0.0 => HPos::Left,
                            1.0 => HPos::Right,
                            _ => HPos::Center,
                        };
                        let style = TextStyle::from((FontFamily::SansSerif, em * EM))
                            .color(colour)
                            .pos(Pos::new(horizontal, VPos::Center));
                        let place = (*x, y + (SINK * em) as i32);
                        backend.draw_text(letters, &style, place)?;
                    }
                }
            }
            backend.present()?;
        }
        Ok(self.named(&text, label))
    }

    /// Completes the SVG `svg` that the backend made: adds the size in pixels, the label of the figure, and the
    /// tooltips of the shapes.
    fn named(&self, svg: &str, label: &str) -> String {
        let (width, height) = (self.size.0 / DETAIL, self.size.1 / DETAIL);
        let label = escaped(label);
        let mut lines = svg.lines();
        let own = format!(
            "<svg width=\"{width}\" height=\"{height}\" role=\"img\" aria-label=\"{label}\""
        );
        let header = lines.next().and_then(|line| line.split_once(" viewBox"));
        let mut named = header.map_or(String::new(), |(_, rest)| format!("{own} viewBox{rest}\n"));
        // The first element of the SVG is the background. After it, each shape has exactly one element.
        let titles = self.shapes.iter().map(|shape| shape.title.as_str());
        let mut titles = std::iter::once("").chain(titles);
        for line in lines {
            let element = line.strip_prefix('<').filter(|rest| !rest.starts_with('/'));
            let title = element.and_then(|_| titles.next()).unwrap_or_default();
            let name = element
                .and_then(|rest| rest.split(' ').next())
                .unwrap_or_default();
            match line.strip_suffix("/>").filter(|_| !title.is_empty()) {
                Some(open) => {
                    named += &format!("{open}><title>{}</title></{name}>\n", escaped(title))
                }
                None => named += &format!("{line}\n"),
            }
        }
        named
    }

    /// The image as PNG data on a white background. It is drawn larger by the factor `DETAIL` and then reduced, so that
    /// edges are smooth.
    #[cfg(feature = "png")]
    fn png(&self) -> Result<Vec<u8>, String> {
        use plotters::backend::BitMapBackend;
        let (width, height) = self.size;
        let bytes = 3 * u64::from(width) * u64::from(height);
        if !(1..MAX_BYTES).contains(&bytes) {
            return Err(format!("{width} x {height} points are too many"));
        }
        let mut large = image::RgbImage::from_pixel(width, height, image::Rgb([255; 3]));
        let mut backend = BitMapBackend::with_buffer(&mut large, self.size);
        for shape in &self.shapes {
            shape
                .draw(&mut backend)
                .map_err(|error| error.to_string())?;
        }
        drop(backend);
        let size = [width / DETAIL, height / DETAIL];
        palpate_frames::png(&large, Some(size)).map_err(|error| error.to_string())
    }
}

#[cfg(feature = "png")]
impl Shape {
    fn draw<B: DrawingBackend>(&self, backend: &mut B) -> Drawn<B::ErrorType> {
        let colour = self.colour;
        match &self.form {
            // Draw each segment separately, because the backend leaves holes where a line crosses itself. Make
            // horizontal and vertical lines one pixel narrower, because the backend draws them one pixel too wide.
            Form::Line(points, width) => {
                for pair in points.windows(2) {
                    let is_straight = pair[0].0 == pair[1].0 || pair[0].1 == pair[1].1;
                    let width = width.saturating_sub(u32::from(is_straight));
                    backend.draw_path(pair.to_vec(), &Color::stroke_width(&colour, width))?;
                }
                let joints = points.iter().skip(1).take(points.len().saturating_sub(2));
                joints
                    .clone()
                    .try_for_each(|joint| backend.draw_circle(*joint, width / 2, &colour, true))
            }
            Form::Polygon(corners) => backend.fill_polygon(corners.clone(), &colour),
            Form::Disc(centre, radius) => backend.draw_circle(*centre, *radius, &colour, true),
            Form::Text(text, (x, y), em, before) => {
                let mut drawn = Ok(());
                let base = (f64::from(*x), f64::from(*y) + (SINK + 0.5 * X_HEIGHT) * em);
                super::lettering::pixels(text, *em, base, *before, |place, covered| {
                    if drawn.is_ok() {
                        drawn = backend.draw_pixel(place, colour.mix(covered).to_backend_color());
                    }
                });
                drawn
            }
        }
    }
}

impl DrawingBackend for Drawing {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn<Infallible> {
        Ok(())
    }

    fn present(&mut self) -> Drawn<Infallible> {
        Ok(())
    }

    fn draw_pixel(&mut self, place: BackendCoord, colour: BackendColor) -> Drawn<Infallible> {
        self.push(Form::Disc(place, 1), colour)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn<Infallible> {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn<Infallible> {
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        match fill {
            true => self.fill_polygon(corners, style),
            false => self.draw_path(corners.into_iter().chain([(left, top)]), style),
        }
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn<Infallible> {
        let line = Form::Line(path.into_iter().collect(), style.stroke_width());
        self.push(line, style.color())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        centre: BackendCoord,
        radius: u32,
        style: &S,
        _fill: bool,
    ) -> Drawn<Infallible> {
        self.push(Form::Disc(centre, radius), style.color())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn<Infallible> {
        let polygon = Form::Polygon(corners.into_iter().collect());
        self.push(polygon, style.color())
    }

    /// Records each line of a text as a separate shape, below the shape of the previous line.
    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        (x, y): BackendCoord,
    ) -> Drawn<Infallible> {
        let em = style.size();
        let before = match style.anchor().h_pos {
            HPos::Left => 0.0,
            HPos::Center => 0.5,
            HPos::Right => 1.0,
        };
        let down = match style.anchor().v_pos {
            VPos::Top => 0.5 * em,
            VPos::Center => 0.0,
            VPos::Bottom => -0.5 * em,
        };
        for (number, line) in text.split('\n').enumerate() {
            let y = y + (down + LEADING * em * number as f64) as i32;
            if line.is_empty() {
                continue;
            }
            self.push(
                Form::Text(line.to_owned(), (x, y), em, before),
                style.color(),
            )?;
        }
        Ok(())
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
