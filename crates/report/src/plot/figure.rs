//! A drawn figure, as SVG and as PNG.

use super::canvas::{Canvas, Point};
use crate::ReportError;

/// Figure as it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of its files, without an ending.
    pub name: String,
    /// Title, which also stands in the picture.
    pub title: String,
    /// The picture as SVG. Its text is text, which a viewer sets in its own sans-serif.
    pub svg: String,
    canvas: Canvas,
    /// Width and height in pixels.
    size: Point,
}

impl Figure {
    /// The figure of what is on the canvas, `size` pixels wide and high.
    pub(crate) fn new(
        name: String,
        title: String,
        canvas: Canvas,
        size: Point,
    ) -> Result<Self, ReportError> {
        let svg = canvas
            .svg(size, &title)
            .map_err(|message| ReportError::Draw {
                path: format!("{name}.svg").into(),
                message,
            })?;
        Ok(Self {
            name,
            title,
            svg,
            canvas,
            size,
        })
    }

    /// Width in pixels.
    pub(crate) const fn width(&self) -> f64 {
        self.size.0
    }

    /// Bytes of the picture as PNG, in pixels of the SVG's size and in the built-in fonts.
    ///
    /// # Errors
    /// The picture is too large.
    #[cfg(feature = "png")]
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        super::pixels::png(&self.canvas, self.size).map_err(|message| ReportError::Draw {
            path: format!("{}.png", self.name).into(),
            message,
        })
    }
}
