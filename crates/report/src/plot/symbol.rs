//! Draws the markers of data points.

use super::style::{Marker, Style, WHITE};
use plotters::element::{Drawable, PointCollection};
use plotters_backend::{BackendCoord, BackendStyle, DrawingBackend, DrawingErrorKind};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Width of the white rim around a marker, in drawing units (1/3 px). The rim separates the marker from shapes below
/// it.
const RIM: f64 = 4.5;

/// A marker of approximately the radius `size`, with a white rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Symbol {
    pub(crate) style: Style,
    pub(crate) size: f64,
    /// Whether the marker is white inside. Dots and dashes are never white inside.
    pub(crate) is_open: bool,
}

pub(crate) struct Placed<C>(pub(crate) C, pub(crate) Symbol);

impl Symbol {
    pub(crate) fn new(style: Style, size: f64) -> Self {
        Self {
            style,
            size,
            is_open: false,
        }
    }

    pub(crate) fn open(self) -> Self {
        Self {
            is_open: true,
            ..self
        }
    }
}

impl<'a, C> PointCollection<'a, C> for &'a Placed<C> {
    type Point = &'a C;
    type IntoIter = std::iter::Once<&'a C>;

    fn point_iter(self) -> Self::IntoIter {
        std::iter::once(&self.0)
    }
}

impl<C, B: DrawingBackend> Drawable<B> for Placed<C> {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        mut places: I,
        backend: &mut B,
        _: (u32, u32),
    ) -> Result<(), DrawingErrorKind<B::ErrorType>> {
        let Some(place) = places.next() else {
            return Ok(());
        };
        let (style, size, is_open) = (self.1.style, self.1.size, self.1.is_open);
        fill(backend, style.marker, place, (size, RIM), &WHITE)?;
        fill(backend, style.marker, place, (size, 0.0), &style.colour)?;
        match style.marker {
            Marker::Dot | Marker::Dash => Ok(()),
            Marker::Ring if !is_open => {
                fill(backend, Marker::Circle, place, (0.5 * size, 0.0), &WHITE)
            }
            marker if is_open => fill(backend, marker, place, (0.55 * size, 0.0), &WHITE),
            _ => Ok(()),
        }
    }
}

/// Fills the shape of a marker. Its radius is approximately `size` plus `rim`.
fn fill<B: DrawingBackend, S: BackendStyle>(
    backend: &mut B,
    marker: Marker,
    place: BackendCoord,
    (size, rim): (f64, f64),
    style: &S,
) -> Result<(), DrawingErrorKind<B::ErrorType>> {
    let r = size + rim;
    // Corners of a rectangle with the side lengths 2 `a` and 2 `b`.
    let bar = |a: f64, b: f64| [(-a, -b), (a, -b), (a, b), (-a, b)];
    let long = bar(1.15 * r, 0.35 * size + rim);
    let (corners, turns): (&[(f64, f64)], &[f64]) = match marker {
        Marker::Circle | Marker::Ring => {
            return backend.draw_circle(place, r.round() as u32, style, true);
        }
        Marker::Dot => {
            let radius = (0.55 * size + rim).round() as u32;
            return backend.draw_circle(place, radius, style, true);
        }
        Marker::Plus => (&long, &[0.0, FRAC_PI_2]),
        Marker::Cross => (&long, &[FRAC_PI_4, 3.0 * FRAC_PI_4]),
        Marker::Dash => (&bar(1.9 * size, 0.25 * size + rim), &[0.0]),
        Marker::Square => (&bar(0.9 * r, 0.9 * r), &[0.0]),
        Marker::Diamond => (&bar(0.85 * r, 0.85 * r), &[FRAC_PI_4]),
        Marker::Up => (
            &[(-1.1 * r, 0.85 * r), (1.1 * r, 0.85 * r), (0.0, -1.15 * r)],
            &[0.0],
        ),
        Marker::Down => (
            &[(-1.1 * r, -0.85 * r), (1.1 * r, -0.85 * r), (0.0, 1.15 * r)],
            &[0.0],
        ),
    };
    for turn in turns {
        let (sine, cosine) = libm::sincos(*turn);
        let turned = corners.iter().map(|(a, b)| {
            let (x, y) = (a * cosine - b * sine, a * sine + b * cosine);
            (place.0 + x.round() as i32, place.1 + y.round() as i32)
        });
        backend.fill_polygon(turned, style)?;
    }
    Ok(())
}
