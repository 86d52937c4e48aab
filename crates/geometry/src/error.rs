//! Errors of surfaces.

use std::ops::RangeInclusive;

use nalgebra::Point3;
use palpate_statistics::{BadSetting, Number};
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Errors of a surface at a point or at parameters of its chart.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum SurfaceError {
    /// The surface has no point there, or its height is undefined or not smooth there.
    #[error("the surface is not defined, or not smooth, {}", place([("x", x), ("y", y)]))]
    OffDomain {
        /// Coordinate in the surface's frame.
        x: f64,
        /// Coordinate in the surface's frame.
        y: f64,
    },
    /// The chart (not the surface) is singular at these parameters, or they are outside of its range.
    #[error("the chart is singular {}", place([("u", u), ("v", v)]))]
    ChartSingular {
        /// First parameter.
        u: f64,
        /// Second parameter.
        v: f64,
    },
    /// Several points of the surface are equally close, as from the centre of a sphere or the axis of a cylinder.
    #[error(
        "no single closest point to ({x}, {y}, {z})",
        x = Number(*x), y = Number(*y), z = Number(*z)
    )]
    NoClosestPoint {
        /// Coordinate of the query point.
        x: f64,
        /// Coordinate of the query point.
        y: f64,
        /// Coordinate of the query point.
        z: f64,
    },
}

/// Text of a place for a message, from the names and values of its coordinates.
fn place(coordinates: [(&str, &f64); 2]) -> String {
    if coordinates.iter().any(|(_, value)| !value.is_finite()) {
        return "at a place beyond the range of numbers".to_owned();
    }
    let words = coordinates.map(|(name, value)| format!("{name} = {}", Number(*value)));
    format!("at {}", words.join(", "))
}

impl SurfaceError {
    pub(crate) fn no_closest_point(point: &Point3<f64>) -> Self {
        Self::NoClosestPoint {
            x: point.x,
            y: point.y,
            z: point.z,
        }
    }
}

/// A parameter of a surface that is out of its range.
pub type InvalidShape = BadSetting;

/// Checks that a parameter is a length whose square neither overflows nor vanishes.
pub(crate) fn checked_length(parameter: &'static str, value: f64) -> Result<f64, InvalidShape> {
    let expected = match value > 0.0 && value.is_finite() {
        true => "between 1e-150 and 1e150",
        false => "finite and > 0",
    };
    BadSetting::unless(SQUARABLE.contains(&value), parameter, value, expected)
}

/// Checks that a parameter is finite.
pub(crate) fn checked_finite(parameter: &'static str, value: f64) -> Result<f64, InvalidShape> {
    BadSetting::unless(value.is_finite(), parameter, value, "finite")
}

/// Range of lengths and slopes whose squares neither overflow nor vanish. Outside of it, vectors cannot be normalised.
pub(crate) const SQUARABLE: RangeInclusive<f64> = 1e-150..=1e150;

/// Whether the coordinates of a place can be squared; false for NaN.
pub(crate) fn is_within_reach(x: f64, y: f64) -> bool {
    x.abs() + y.abs() <= *SQUARABLE.end()
}
