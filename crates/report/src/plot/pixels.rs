//! Shapes as pixels.

use super::canvas::{Anchor, Canvas, Form, Point, SINK};
use super::lettering::Lettering;
use super::style::{Colour, WHITE};
use ab_glyph::OutlineCurve;
use image::codecs::png::PngEncoder;
use image::{ColorType, ImageEncoder};
use tiny_skia::{Color, FillRule, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

/// Bytes of a PNG of the shapes on a white ground, `size` pixels wide and high.
pub(crate) fn png(canvas: &Canvas, (width, height): Point) -> Result<Vec<u8>, String> {
    let pixels = drawn(canvas, (width as u32, height as u32))
        .ok_or_else(|| format!("{width} x {height} pixels are too many"))?;
    let (width, height) = (pixels.width(), pixels.height());
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(pixels.data(), width, height, ColorType::Rgba8)
        .map_err(|error| error.to_string())?;
    Ok(png)
}

fn drawn(canvas: &Canvas, (width, height): (u32, u32)) -> Option<Pixmap> {
    let mut pixels = Pixmap::new(width, height)?;
    pixels.fill(paint(WHITE));
    for shape in canvas.shapes() {
        let Some((path, stroke)) = outline(&shape.form) else {
            continue;
        };
        let mut ink = Paint::default();
        ink.set_color(paint(shape.colour));
        match stroke {
            Some(stroke) => pixels.stroke_path(&path, &ink, &stroke, Transform::default(), None),
            None => pixels.fill_path(&path, &ink, FillRule::Winding, Transform::default(), None),
        }
    }
    Some(pixels)
}

fn paint(Colour(red, green, blue): Colour) -> Color {
    Color::from_rgba8(red, green, blue, 255)
}

/// Outline of a form, and the pen where the outline itself is drawn; none of a form without extent.
fn outline(form: &Form) -> Option<(Path, Option<Stroke>)> {
    match form {
        Form::Line(points, width) => {
            let width = *width as f32;
            let pen = Stroke {
                width,
                ..Stroke::default()
            };
            Some((through(points).finish()?, Some(pen)))
        }
        Form::Polygon(points) => {
            let mut path = through(points);
            path.close();
            Some((path.finish()?, None))
        }
        Form::Disc((x, y), radius) => {
            let path = PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32)?;
            Some((path, None))
        }
        Form::Text(text, place, size, anchor) => {
            Some((letters(text, *place, *size, *anchor)?, None))
        }
    }
}

fn through(points: &[Point]) -> PathBuilder {
    let mut path = PathBuilder::new();
    for (index, (x, y)) in points.iter().enumerate() {
        let (x, y) = (*x as f32, *y as f32);
        match index {
            0 => path.move_to(x, y),
            _ => path.line_to(x, y),
        }
    }
    path
}

/// Outlines of a text whose middle height is at `place`.
fn letters(text: &str, (x, y): Point, size: f64, anchor: Anchor) -> Option<Path> {
    let lettering = Lettering::new(text, size);
    let start = match anchor {
        Anchor::Left => 0.0,
        Anchor::Middle => 0.5 * lettering.width,
        Anchor::Right => lettering.width,
    };
    let sink = SINK * size + 0.5 * lettering.x_height;
    let (left, base) = (x as f32 - start, (y + sink) as f32);
    let mut path = PathBuilder::new();
    let mut end = None;
    for curve in &lettering.curves {
        let (OutlineCurve::Line(first, ..)
        | OutlineCurve::Quad(first, ..)
        | OutlineCurve::Cubic(first, ..)) = curve;
        if end != Some(*first) {
            path.move_to(left + first.x, base + first.y);
        }
        let at = |point: &ab_glyph::Point| (left + point.x, base + point.y);
        end = Some(match curve {
            OutlineCurve::Line(_, c) => {
                path.line_to(at(c).0, at(c).1);
                *c
            }
            OutlineCurve::Quad(_, b, c) => {
                path.quad_to(at(b).0, at(b).1, at(c).0, at(c).1);
                *c
            }
            OutlineCurve::Cubic(_, a, b, c) => {
                path.cubic_to(at(a).0, at(a).1, at(b).0, at(b).1, at(c).0, at(c).1);
                *c
            }
        });
    }
    path.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::style::INK;

    /// Left, right, upper and lower edge of what is dark.
    fn extent(anchor: Anchor) -> [u32; 4] {
        let mut canvas = Canvas::default();
        canvas.text("H", (100.0, 100.0), 80.0, anchor, INK);
        let pixels = drawn(&canvas, (200, 200)).unwrap();
        let dark = (0..200).flat_map(|y| (0..200).map(move |x| (x, y)));
        let dark = dark.filter(|(x, y)| pixels.pixel(*x, *y).unwrap().red() < 128);
        dark.fold([200, 0, 200, 0], |[left, right, top, bottom], (x, y)| {
            [left.min(x), right.max(x), top.min(y), bottom.max(y)]
        })
    }

    #[test]
    fn a_capital_stands_around_its_place() {
        let [left, right, top, bottom] = extent(Anchor::Middle);
        assert!((195..=205).contains(&(left + right)), "{left} to {right}");
        assert!((195..=205).contains(&(top + bottom)), "{top} to {bottom}");
        assert!((50..=62).contains(&(bottom - top)), "{top} to {bottom}");
        assert!(extent(Anchor::Left)[0] >= 100 && extent(Anchor::Right)[1] <= 100);
    }

    #[test]
    fn a_picture_that_is_too_large_is_told() {
        assert!(png(&Canvas::default(), (1e9, 1e9)).is_err());
        assert!(png(&Canvas::default(), (0.0, 10.0)).is_err());
    }
}
