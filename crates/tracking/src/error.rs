//! Errors of frames in which no markers can be found.

use palpate_statistics::Number;
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Why a frame, or the settings to read it by, gives no markers.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum TrackingError {
    /// The frame has no pixels.
    #[error("the frame has no pixels: {width} by {height}")]
    EmptyImage {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The frame, or what the mask leaves of it, is too small to hold a marker.
    #[error("{width} by {height} px are too few: at least {least} by {least} are needed")]
    TooSmall {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// The least number of either.
        least: u32,
    },
    /// The frame is larger than is read.
    #[error("{width} by {height} px are too many: at most {most} by {most} are read")]
    TooLarge {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// The largest number of either.
        most: u32,
    },
    /// The image circle is not a circle, or lies outside the frame.
    #[error(
        "the image circle about ({x_px}, {y_px}) of radius {radius_px} px shows nothing of the \
         frame: its centre must lie in the frame and its radius be positive",
        x_px = Number(*x_px), y_px = Number(*y_px), radius_px = Number(*radius_px)
    )]
    MaskOutside {
        /// Column of the centre.
        x_px: f64,
        /// Row of the centre.
        y_px: f64,
        /// Radius.
        radius_px: f64,
    },
    /// The markers' diameter is not a length of at least a pixel.
    #[strum(serialize = "marker-diameter")]
    #[error(
        "a marker's diameter of {diameter_px} px: it must be at least {least} px and finite",
        diameter_px = Number(*diameter_px)
    )]
    Diameter {
        /// Diameter that was asked for, px.
        diameter_px: f64,
        /// The least that is read.
        least: f64,
    },
    /// Nothing sets itself off from the ground as a marker does.
    #[error(
        "no markers: {shapes} shape(s) set off from the ground, none of the size, form and colour \
         of a marker: are colours swapped?"
    )]
    NoMarkers {
        /// Connected shapes that were looked at.
        shapes: usize,
    },
    /// More shapes than a sensor has markers: noise, or not a frame of a sensor.
    #[error("{shapes} shapes set themselves off from the ground: at most {most} are looked at")]
    TooMany {
        /// How many there are.
        shapes: usize,
        /// The largest number.
        most: usize,
    },
}

impl TrackingError {
    /// The stable name of this kind of error.
    pub fn name(&self) -> &'static str {
        self.into()
    }
}
