//! The config of a fingertip by itself: a sphere with markers that touches nothing.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::press::PressProbeConfig;

/// A sensor is cut, folded and looked at, and pressed onto nothing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BareFingertipConfig {
    /// The sensor: a sphere with markers under its skin, as of a press.
    pub probe: PressProbeConfig,
    /// The camera in its centre, whose lens and pixels the image of a marker depends on.
    #[serde(default)]
    pub sensor: LensConfig,
    /// Place of the marker that is looked at; how large it looks depends on it.
    #[serde(default)]
    pub view: ViewConfig,
}

/// A camera in the sensor's centre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LensConfig {
    /// How angles become distances in the image.
    #[serde(default)]
    pub lens: LensName,
    /// Pixels along each side of the square image.
    #[serde(default = "pixels")]
    #[schemars(extend("minimum" = 1, "maximum" = 8192))]
    pub size_px: u32,
    /// Polar angle that the image's inscribed circle shows: of a pinhole less than 90.
    #[serde(default = "field")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 180))]
    pub field_deg: f64,
}

impl Default for LensConfig {
    fn default() -> Self {
        Self {
            lens: LensName::default(),
            size_px: pixels(),
            field_deg: field(),
        }
    }
}

fn pixels() -> u32 {
    640
}

fn field() -> f64 {
    65.0
}

/// How angles become distances in the image.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LensName {
    /// A lens with distances from the middle in proportion to the polar angle.
    #[default]
    Fisheye,
    /// A lens with distances from the middle in proportion to the angle's tangent.
    Pinhole,
}

/// Place of the marker that is looked at.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ViewConfig {
    /// Polar angle from the apex.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "maximum" = 180))]
    pub polar_deg: f64,
}
