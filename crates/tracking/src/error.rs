//! Errors of the search for markers in a frame.

use palpate_statistics::Number;
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Reason why no markers can be found in a frame.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum TrackingError {
    /// The frame has no pixels.
    #[error("the frame has no pixels: {width} by {height}")]
    EmptyImage {
        /// Number of columns of the frame.
        width: u32,
        /// Number of rows of the frame.
        height: u32,
    },
    /// The frame, or its part inside the image circle, is too small for a marker.
    #[error("the frame has {width} by {height} px; at least {least} by {least} are needed")]
    TooSmall {
        /// Number of columns of the frame or of its part inside the image circle.
        width: u32,
        /// Number of rows of the frame or of its part inside the image circle.
        height: u32,
        /// Smallest allowed number of columns and of rows of a frame.
        least: u32,
    },
    /// The frame has more columns or rows than the finder accepts.
    #[error("the frame has {width} by {height} px; at most {most} by {most} are accepted")]
    TooLarge {
        /// Number of columns of the frame.
        width: u32,
        /// Number of rows of the frame.
        height: u32,
        /// Largest allowed number of columns and of rows of a frame.
        most: u32,
    },
    /// The radius of the image circle is not positive, or the circle's centre lies outside the frame.
    #[error(
        "the image circle around ({x_px}, {y_px}) with a radius of {radius_px} px is not valid: \
         its centre must lie in the frame and its radius must be positive",
        x_px = Number(*x_px), y_px = Number(*y_px), radius_px = Number(*radius_px)
    )]
    MaskOutside {
        /// Column of the centre of the image circle.
        x_px: f64,
        /// Row of the centre of the image circle.
        y_px: f64,
        /// Radius of the image circle, px.
        radius_px: f64,
    },
    /// No shape in the frame has the size, the form and the colour of a marker.
    #[error(
        "no markers: {shapes} shape(s) differ from the background, but none has the size, form \
         and colour of a marker: are colours swapped, or is the frame grey?"
    )]
    NoMarkers {
        /// Number of connected shapes that were examined.
        shapes: usize,
    },
    /// The frame has more connected shapes than the finder accepts. Either the frame is noisy, or it does not show a
    /// sensor.
    #[error("{shapes} shapes differ from the background; at most {most} are allowed")]
    TooMany {
        /// Number of connected shapes in the frame.
        shapes: usize,
        /// Largest allowed number of connected shapes in a frame.
        most: usize,
    },
}
