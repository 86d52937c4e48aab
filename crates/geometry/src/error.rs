//! The error types of surfaces, and checks of the surfaces' parameters.

use std::ops::RangeInclusive;

use nalgebra::Point3;
use palpate_statistics::{BadSetting, Number};
use strum::{IntoStaticStr, VariantNames};
use thiserror::Error;

/// Reasons why a surface cannot be evaluated at a point or at chart parameters.
#[derive(Clone, Copy, Debug, Error, IntoStaticStr, PartialEq, VariantNames)]
#[strum(serialize_all = "kebab-case")]
pub enum SurfaceError {
    /// The surface has no point at `(x, y)`, or its height is undefined or not smooth there.
    #[error("the surface is not defined, or not smooth, {}", place([("x", x), ("y", y)]))]
    OffDomain {
        /// x coordinate in the surface's frame.
        x: f64,
        /// y coordinate in the surface's frame.
        y: f64,
    },
    /// The parameters are outside of the chart's range, or the chart is singular there. The surface itself may be
    /// smooth there.
    #[error("the chart is singular {}", place([("u", u), ("v", v)]))]
    ChartSingular {
        /// Value of the chart's first parameter.
        u: f64,
        /// Value of the chart's second parameter.
        v: f64,
    },
    /// Several points of the surface are equally close to the query point. An example is a query point at the centre of
    /// a sphere or on the axis of a cylinder.
    #[error(
        "no single closest point to ({x}, {y}, {z})",
        x = Number(*x), y = Number(*y), z = Number(*z)
    )]
    NoClosestPoint {
        /// x coordinate of the query point.
        x: f64,
        /// y coordinate of the query point.
        y: f64,
        /// z coordinate of the query point.
        z: f64,
    },
}

fn place(coordinates: [(&str, &f64); 2]) -> String {
    if coordinates.iter().any(|(_, value)| !value.is_finite()) {
        return "at a place beyond the range of numbers".to_owned();
    }
    let words = coordinates.map(|(name, value)| format!("{name} = {}", Number(*value)));
    format!("at {}", words.join(", "))
}

impl SurfaceError {
    pub(crate) fn off_domain(point: &Point3<f64>) -> Self {
        let (x, y) = (point.x, point.y);
        Self::OffDomain { x, y }
    }

    pub(crate) fn no_closest_point(point: &Point3<f64>) -> Self {
        Self::NoClosestPoint {
            x: point.x,
            y: point.y,
            z: point.z,
        }
    }
}

/// Checks that a parameter is a valid length: its square must not overflow or underflow to zero.
pub(crate) fn checked_length(parameter: &'static str, value: f64) -> Result<f64, BadSetting> {
    let expected = match value > 0.0 && value.is_finite() {
        true => "between 1e-150 and 1e150",
        false => "finite and > 0",
    };
    BadSetting::unless(SQUARABLE.contains(&value), parameter, value, expected)
}

pub(crate) fn checked_finite(parameter: &'static str, value: f64) -> Result<f64, BadSetting> {
    BadSetting::unless(value.is_finite(), parameter, value, "finite")
}

/// Range of valid lengths and slopes. Outside of this range, their squares overflow or underflow, so vectors cannot be
/// scaled to length 1.
pub(crate) const SQUARABLE: RangeInclusive<f64> = 1e-150..=1e150;

/// Whether the squares of both coordinates are within the range of doubles; `false` for NaN.
pub(crate) fn is_within_reach(x: f64, y: f64) -> bool {
    x.abs() + y.abs() <= *SQUARABLE.end()
}
