//! Lines, shapes and text on any plotters backend, in pixels of the finished picture.

use super::lettering;
use super::picture::Picture;
use super::style::Marker;
use crate::ReportError;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;

/// Backends count in whole units; a pixel of the picture has this many, so that curves and text keep their shape.
const DETAIL: u32 = 3;
/// The SVG backend divides a font's size by this to get the size of its em.
const EM: f64 = 1.24;
/// Shift of text downward, in ems: the SVG backend centres small letters, and capitals and digits are to be centred.
const SINK: f64 = 0.09;

/// A place in the picture, from its upper left corner.
pub(crate) type Point = (f64, f64);

/// Result of a drawing step; an error holds the message of the backend.
pub(crate) type Drawn = Result<(), String>;

/// Which point of a text stands at its place.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Anchor {
    Left,
    Middle,
    Right,
}

/// Way in which text reaches a backend.
#[derive(Debug, Clone, Copy)]
enum Lettering {
    /// Text elements, which the viewer sets in its own sans-serif.
    Text,
    /// Pixels drawn here, because plotters' own rasteriser drops the space before each letter.
    Pixels,
}

/// A drawing surface.
pub(crate) struct Canvas<B: DrawingBackend> {
    area: DrawingArea<B, Shift>,
    lettering: Lettering,
}

impl<B: DrawingBackend> Canvas<B> {
    fn unit(value: f64) -> i32 {
        (value * f64::from(DETAIL)).round() as i32
    }

    fn at((x, y): Point) -> (i32, i32) {
        (Self::unit(x), Self::unit(y))
    }

    /// Fills the picture.
    pub(crate) fn fill(&self, colour: RGBColor) -> Drawn {
        self.area.fill(&colour).map_err(|e| e.to_string())
    }

    /// A line through `points`, `width` pixels wide.
    pub(crate) fn line(&self, points: &[Point], colour: RGBColor, width: f64) -> Drawn {
        let style = colour.stroke_width(Self::unit(width).max(1) as u32);
        let path: Vec<_> = points.iter().map(|p| Self::at(*p)).collect();
        self.area
            .draw(&PathElement::new(path, style))
            .map_err(|e| e.to_string())
    }

    /// A dashed line through `points`.
    pub(crate) fn dashes(&self, points: &[Point], colour: RGBColor, width: f64) -> Drawn {
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
                    self.line(&[along(from), along(to)], colour, width)?;
                }
                dash += PERIOD;
            }
            done += length;
        }
        Ok(())
    }

    /// A filled polygon.
    pub(crate) fn polygon(&self, points: &[Point], colour: RGBColor) -> Drawn {
        let path: Vec<_> = points.iter().map(|p| Self::at(*p)).collect();
        self.area
            .draw(&Polygon::new(path, colour.filled()))
            .map_err(|e| e.to_string())
    }

    /// A filled circle.
    pub(crate) fn disc(&self, centre: Point, radius: f64, colour: RGBColor) -> Drawn {
        self.area
            .draw(&Circle::new(
                Self::at(centre),
                Self::unit(radius),
                colour.filled(),
            ))
            .map_err(|e| e.to_string())
    }

    /// One line of text whose middle height is at `place`.
    pub(crate) fn text(
        &self,
        text: &str,
        place: Point,
        size: f64,
        anchor: Anchor,
        colour: RGBColor,
    ) -> Drawn {
        match self.lettering {
            Lettering::Text => self.text_as_text(text, place, size, anchor, colour),
            Lettering::Pixels => self.text_as_pixels(text, place, size, anchor, colour),
        }
    }

    fn text_as_text(
        &self,
        text: &str,
        (x, y): Point,
        size: f64,
        anchor: Anchor,
        colour: RGBColor,
    ) -> Drawn {
        let horizontal = match anchor {
            Anchor::Left => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        let style = TextStyle::from(("sans-serif", size * EM * f64::from(DETAIL)).into_font())
            .color(&colour)
            .pos(Pos::new(horizontal, VPos::Center));
        self.area
            .draw_text(text, &style, Self::at((x, y + SINK * size)))
            .map_err(|e| e.to_string())
    }

    fn text_as_pixels(
        &self,
        text: &str,
        place: Point,
        size: f64,
        anchor: Anchor,
        colour: RGBColor,
    ) -> Drawn {
        let (pixels, width) = lettering::pixels(text, size * f64::from(DETAIL));
        let (x, y) = Self::at(place);
        let left = match anchor {
            Anchor::Left => x,
            Anchor::Middle => x - (width / 2.0) as i32,
            Anchor::Right => x - width as i32,
        };
        for (dx, dy, share) in pixels {
            self.area
                .draw_pixel((left + dx, y + dy), &colour.mix(share))
                .map_err(|e| e.to_string())?;
        }
        Ok(())
    }

    /// A marker of about `size` pixels in radius on a white rim.
    pub(crate) fn marker(
        &self,
        marker: Marker,
        place: Point,
        size: f64,
        colour: RGBColor,
    ) -> Drawn {
        for (grow, colour) in [(1.5, WHITE), (0.0, colour)] {
            self.shape(marker, place, size, grow, colour)?;
        }
        if marker == Marker::Ring {
            self.disc(place, 0.5 * size, WHITE)
        } else {
            Ok(())
        }
    }

    /// The outline of such a marker, white within unless it is never open.
    pub(crate) fn open_marker(
        &self,
        marker: Marker,
        place: Point,
        size: f64,
        colour: RGBColor,
    ) -> Drawn {
        self.marker(marker, place, size, colour)?;
        match marker {
            Marker::Dot | Marker::Dash => Ok(()),
            _ => self.shape(marker, place, 0.55 * size, 0.0, WHITE),
        }
    }

    /// The shape of a marker of about `size + grow` pixels in radius, whose bars are those of `size`, as much wider.
    fn shape(
        &self,
        marker: Marker,
        (x, y): Point,
        size: f64,
        grow: f64,
        colour: RGBColor,
    ) -> Drawn {
        let r = size + grow;
        let corners = |corners: &[(f64, f64)]| {
            let points: Vec<Point> = corners
                .iter()
                .map(|(dx, dy)| (x + r * dx, y + r * dy))
                .collect();
            self.polygon(&points, colour)
        };
        let bars = |turn: f64| -> Drawn {
            let (r, half) = (r * 1.15, 0.35 * size + grow);
            for (c, s) in [
                (libm::cos(turn), libm::sin(turn)),
                (-libm::sin(turn), libm::cos(turn)),
            ] {
                let corner = |a: f64, b: f64| (x + a * c - b * s, y + a * s + b * c);
                self.polygon(
                    &[
                        corner(-r, -half),
                        corner(r, -half),
                        corner(r, half),
                        corner(-r, half),
                    ],
                    colour,
                )?;
            }
            Ok(())
        };
        match marker {
            Marker::Circle | Marker::Ring => self.disc((x, y), r, colour),
            Marker::Dot => self.disc((x, y), 0.55 * size + grow, colour),
            Marker::Dash => {
                let (wide, high) = (1.9 * size, 0.25 * size + grow);
                let (left, right, top, bottom) = (x - wide, x + wide, y - high, y + high);
                self.polygon(
                    &[(left, top), (right, top), (right, bottom), (left, bottom)],
                    colour,
                )
            }
            Marker::Square => corners(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
            Marker::Up => corners(&[(-1.1, 0.85), (1.1, 0.85), (0.0, -1.15)]),
            Marker::Down => corners(&[(-1.1, -0.85), (1.1, -0.85), (0.0, 1.15)]),
            Marker::Diamond => corners(&[(-1.2, 0.0), (0.0, -1.2), (1.2, 0.0), (0.0, 1.2)]),
            Marker::Plus => bars(0.0),
            Marker::Cross => bars(std::f64::consts::FRAC_PI_4),
        }
    }
}

/// The picture as SVG text.
pub(crate) fn svg(picture: &Picture, path: &Path) -> Result<String, ReportError> {
    let failed = |message: String| ReportError::Draw {
        path: path.to_owned(),
        message,
    };
    let size = picture.size();
    let (width, height) = (size.0 as u32, size.1 as u32);
    let units = (width * DETAIL, height * DETAIL);
    let mut text = String::new();
    {
        let canvas = Canvas {
            area: SVGBackend::with_string(&mut text, units).into_drawing_area(),
            lettering: Lettering::Text,
        };
        picture.draw(&canvas).map_err(failed)?;
        canvas.area.present().map_err(|e| failed(e.to_string()))?;
    }
    // The backend knows one size only: give the picture its own, keep the units of its content, and name it.
    let backend = format!("width=\"{}\" height=\"{}\" viewBox", units.0, units.1);
    let label = escaped(picture.title());
    let own = format!(
        "width=\"{width}\" height=\"{height}\" role=\"img\" aria-label=\"{label}\" viewBox"
    );
    Ok(picture.titled(text.replacen(&backend, &own, 1)))
}

/// A text as it stands in an SVG.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

/// Writes the picture as PNG to `path`.
pub(crate) fn png(picture: &Picture, path: &Path) -> Result<(), ReportError> {
    let failed = |message: String| ReportError::Draw {
        path: path.to_owned(),
        message,
    };
    let size = picture.size();
    let (width, height) = (size.0 as u32, size.1 as u32);
    let mut fine = vec![255; (3 * width * DETAIL * height * DETAIL) as usize];
    {
        let backend = BitMapBackend::with_buffer(&mut fine, (width * DETAIL, height * DETAIL));
        let canvas = Canvas {
            area: backend.into_drawing_area(),
            lettering: Lettering::Pixels,
        };
        picture.draw(&canvas).map_err(failed)?;
        canvas.area.present().map_err(|e| failed(e.to_string()))?;
    }
    let pixels = shrink(&fine, width as usize);
    let mut backend = BitMapBackend::new(path, (width, height));
    backend
        .blit_bitmap((0, 0), (width, height), &pixels)
        .map_err(|e| failed(e.to_string()))?;
    backend.present().map_err(|e| failed(e.to_string()))
}

/// The mean of each square of `DETAIL` × `DETAIL` RGB units.
fn shrink(fine: &[u8], width: usize) -> Vec<u8> {
    let detail = DETAIL as usize;
    let row = 3 * width * detail;
    let mut pixels = Vec::with_capacity(fine.len() / (detail * detail));
    for band in fine.chunks_exact(row * detail) {
        for x in 0..width {
            for channel in 0..3 {
                let units = (0..detail * detail)
                    .map(|k| (k / detail) * row + 3 * (x * detail + k % detail) + channel);
                let sum: usize = units.map(|at| usize::from(band[at])).sum();
                pixels.push((sum / (detail * detail)) as u8);
            }
        }
    }
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shrinking_averages() {
        let detail = DETAIL as usize;
        let mut fine = vec![0; 3 * 2 * detail * detail];
        fine[..3].copy_from_slice(&[90, 180, 9]);
        assert_eq!(shrink(&fine, 2), [10, 20, 1, 0, 0, 0]);
    }
}
