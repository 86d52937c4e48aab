//! A camera in the sensor's centre.

use super::zero::is_zero;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The camera and the way from its pictures to displacements. The lens is a fisheye, equidistant unless it has odd terms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraConfig {
    /// Pixels along each side of the square image.
    #[serde(default = "pixels")]
    #[schemars(extend("minimum" = 1, "maximum" = 8192))]
    pub size_px: u32,
    /// Polar angle that the image's inscribed circle shows.
    #[serde(default = "field")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 180))]
    pub field_deg: f64,
    /// Odd term of the third power of the fisheye: a polar angle θ, rad, is seen f (θ + k3 θ³ + k5 θ⁵) from the image's centre.
    /// The rim shows `field_deg` whatever the terms, and f follows from that.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(extend("minimum" = -100, "maximum" = 100, "x-unit" = "1"))]
    pub k3: f64,
    /// Odd term of the fifth power.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(extend("minimum" = -100, "maximum" = 100, "x-unit" = "1"))]
    pub k5: f64,
    /// Light at the rim of the field, as a share of that in the middle; of a rendered sensor.
    #[serde(default = "even")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1, "x-unit" = "1"))]
    pub light_at_rim: f64,
    /// Standard deviation of the blur, pixels; of a rendered sensor.
    #[serde(default)]
    #[schemars(extend("minimum" = 0))]
    pub blur_px: f64,
    /// Width of the seams between gores; of a rendered sensor whose layout has gores.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub seam_width: f64,
    /// Place of the camera from the sensor's centre: along the apex's x and y axes, and toward the apex. By default it is
    /// in the very centre.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(extend("x-unit" = "length"))]
    pub place: [f64; 3],
    /// Turn of the camera about the apex's x and y axes and about the way to the apex, as a rotation vector; by default it
    /// looks at the apex.
    #[serde(default, skip_serializing_if = "is_default")]
    pub turn_deg: [f64; 3],
    /// Feature of a marker's picture that tells its normal displacement.
    #[serde(default)]
    pub normal_from: NormalFrom,
    /// Presses on a plane that calibrate the sensor.
    #[serde(default)]
    pub calibration: CalibrationConfig,
    /// Whether displacements along the skin are read too.
    #[serde(default = "yes")]
    pub tangential: bool,
    /// How many frames of a press are averaged.
    #[serde(default = "one")]
    #[schemars(extend("minimum" = 1))]
    pub frames: u32,
}

fn is_default(numbers: &[f64; 3]) -> bool {
    *numbers == [0.0; 3]
}

fn pixels() -> u32 {
    640
}

fn field() -> f64 {
    65.0
}

fn even() -> f64 {
    1.0
}

fn yes() -> bool {
    true
}

fn one() -> u32 {
    1
}

/// Feature of a marker's picture that tells its normal displacement.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NormalFrom {
    /// Its mean hue, as the 2020 paper has it: the difference between the displacements of its two discs.
    Hue,
    /// Its size: the displacement towards the camera.
    Size,
    /// Both, weighted as calibrated.
    #[default]
    Both,
}

/// Presses on a plane, apex down, that calibrate the sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CalibrationConfig {
    /// How many, in equal steps of indentation.
    #[serde(default = "seven")]
    #[schemars(extend("minimum" = 2, "maximum" = 1000))]
    pub presses: u32,
    /// Indentation of the deepest; by default that of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub indentation: Option<f64>,
    /// How many frames at rest are averaged. They and the calibrating presses are taken once: what they err by is the same in all trials.
    #[serde(default = "sixteen")]
    #[schemars(extend("minimum" = 1, "maximum" = 1000))]
    pub rest_frames: u32,
    /// Markers whose normal displacement is known.
    #[serde(default)]
    pub markers: ShownMarkers,
}

impl Default for CalibrationConfig {
    fn default() -> Self {
        Self {
            presses: seven(),
            indentation: None,
            rest_frames: sixteen(),
            markers: ShownMarkers::default(),
        }
    }
}

fn seven() -> u32 {
    7
}

fn sixteen() -> u32 {
    16
}

/// The markers that calibrate.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ShownMarkers {
    /// All, from the model.
    #[default]
    All,
    /// The one under the contact, as in the 2020 paper.
    UnderContact,
}
