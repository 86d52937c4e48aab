//! The config of a glide: fingers slide over a patch of an object, and the patch's curvature is estimated.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::glide_estimator::GlideEstimatorConfig;
use super::object::ObjectConfig;
use super::roll::PadLayout;
use super::schema::{number, whole};

/// Fingers slide over an object, each in its own vertical plane. The planes are parallel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GlideConfig {
    /// The fingertip that touches the object.
    pub probe: FingertipConfig,
    /// The object over whose surface the fingers slide.
    pub object: ObjectConfig,
    /// Position of the middle of the patch: x and y in the object's frame. The default is x = y = 0; on a torus, the
    /// default is a point at the top of the tube.
    #[schemars(extend("x-unit" = "length"))]
    pub object_contact: Option<[f64; 2]>,
    /// Paths of the fingers, and the contacts along these paths.
    pub motion: GlideMotionConfig,
    /// The model that computes the contacts.
    #[serde(default)]
    pub model: GlideModelConfig,
    /// The sensor that reads the contacts.
    #[serde(default)]
    pub sensor: GlideSensorConfig,
    /// Errors of the sensor's readings.
    #[serde(default)]
    pub noise: GlideNoiseConfig,
    /// The estimator of the patch's surface and curvature.
    #[serde(default)]
    pub estimator: GlideEstimatorConfig,
    /// Points of the patch at which estimates are compared with the true values.
    pub evaluate: EvaluateConfig,
    /// Whether the result tables also have the object's principal curvatures, their direction and the object's radius.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub principal_curvatures: bool,
}

impl GlideConfig {
    pub(super) fn check(&self) -> Result<(), (&'static str, &'static str)> {
        const POSITION: &str = "scene.noise.position";
        match self.noise.position {
            Some(PositionNoise::Gaussian {
                fraction_of_ifd: None,
                std: None,
                ..
            }) => return Err((POSITION, "needs `std`, a length, or `fraction_of_ifd`")),
            Some(PositionNoise::Uniform {
                fraction_of_ifd: None,
                bound: None,
                ..
            }) => return Err((POSITION, "needs `bound`, a length, or `fraction_of_ifd`")),
            _ => {}
        }
        match (&self.probe, &self.sensor) {
            (FingertipConfig::Point {}, GlideSensorConfig::Pads { .. }) => Err((
                "scene.sensor",
                "pads need a round tip: `scene.probe` with kind = \"sphere\"",
            )),
            _ => self
                .estimator
                .check()
                .map_err(|message| ("scene.estimator.gamma", message)),
        }
    }
}

/// The shape of a fingertip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum FingertipConfig {
    /// A point. The contact is at the position of the point.
    Point {},
    /// A ball. On a slope, its contact point is not its lowest point.
    Sphere {
        /// Radius of the ball.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
}

/// Paths of the fingers, and the contacts along these paths. Each finger moves along +x in a plane of constant y.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GlideMotionConfig {
    /// y coordinates of the planes of the fingers, relative to the middle of the patch.
    #[schemars(extend("minItems" = 1, "x-unit" = "length"))]
    pub finger_positions: Vec<f64>,
    /// Distance between neighbouring fingers. The position noise may be stated as a fraction of this distance. The
    /// lengths in the settings of the estimator `two-pass` are in units of this distance.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub inter_finger_distance: f64,
    /// Distance between the first and the last contact of each finger, along x.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub patch_length: f64,
    /// Number of contacts of each finger, equally spaced and centred on the patch.
    #[schemars(extend("minimum" = 1, "maximum" = 100_000))]
    pub contacts_per_finger: u32,
}

/// The model that computes the contacts of the fingertips.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum GlideModelConfig {
    /// The closed form of the contact point if one exists for the shapes of tip and object, otherwise Newton's method.
    Auto {
        /// Largest error of a contact's position, relative to the tip's radius.
        #[serde(default = "tolerance")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
    },
    /// The closed form of the contact point. It exists for point tips, and for round tips on planes, spheres, dishes
    /// and cylinders.
    ClosedForm {},
    /// Newton's method for a round tip. It finds the centre of the tip, which lies on a surface at the distance of the
    /// tip's radius from the object.
    Newton {
        /// Largest error of a contact's position, relative to the tip's radius.
        #[serde(default = "tolerance")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
    },
}

fn tolerance() -> f64 {
    1e-12
}

impl Default for GlideModelConfig {
    fn default() -> Self {
        Self::Auto {
            tolerance: tolerance(),
        }
    }
}

/// The sensor that reads the contacts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum GlideSensorConfig {
    /// An ideal sensor, whose readings have no error.
    Ideal {
        /// Whether the sensor also reports the normals at the contacts.
        #[serde(default = "yes")]
        normals: bool,
        /// The point of the fingertip that the sensor reports.
        #[serde(default)]
        reports: Reports,
    },
    /// An array of pads around the lowest point of a round tip. The pad nearest to the contact reports its own centre
    /// instead of the contact point. The direction from the tip's centre to this pad is used as the normal. Therefore,
    /// the reported contact points and normals are rounded to the positions and directions of the pads.
    Pads {
        /// Distance between neighbouring pads.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        pitch: f64,
        /// Arrangement of the pads on the tip.
        #[serde(default)]
        layout: PadLayout,
        /// Largest angle between a pad and the middle of the array, seen from the tip's centre.
        #[serde(default = "number::<90>")]
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 180))]
        cap_deg: f64,
        /// Whether the sensor also reports the normals at the contacts.
        #[serde(default = "yes")]
        normals: bool,
    },
}

fn yes() -> bool {
    true
}

impl Default for GlideSensorConfig {
    fn default() -> Self {
        Self::Ideal {
            normals: true,
            reports: Reports::default(),
        }
    }
}

/// The point of a fingertip that an ideal sensor reports.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Reports {
    /// The contact point, which may be anywhere on the tip.
    #[default]
    Contact,
    /// The lowest point of the tip. The estimator computes the contact point from this point, the tip's radius and the
    /// normal at the contact. If the sensor reports no normals, the normal comes from a first fit to the centres of the
    /// tips.
    LowestPoint,
}

/// Errors of the sensor's readings; an error that is not stated is 0.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GlideNoiseConfig {
    /// Error of the contacts' coordinates.
    pub position: Option<PositionNoise>,
    /// Error of the normal at each contact.
    pub normal: Option<NormalNoise>,
}

/// Error of a contact's coordinates. The error of each coordinate is drawn independently.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PositionNoise {
    /// Gaussian error with mean 0.
    Gaussian {
        /// Standard deviation of the error as a fraction of the inter-finger distance. State either this or `std`.
        #[schemars(extend("minimum" = 0, "x-instead-of" = ["std"]))]
        fraction_of_ifd: Option<f64>,
        /// Standard deviation of the error. State either this or `fraction_of_ifd`.
        #[schemars(extend("minimum" = 0, "x-unit" = "length", "x-instead-of" = ["fraction_of_ifd"]))]
        std: Option<f64>,
        /// Coordinates of the contact that have the error.
        #[serde(default)]
        axis: NoiseAxis,
    },
    /// Uniform error between −bound and +bound.
    Uniform {
        /// Bound of the error as a fraction of the inter-finger distance. State either this or `bound`.
        #[schemars(extend("minimum" = 0, "x-instead-of" = ["bound"]))]
        fraction_of_ifd: Option<f64>,
        /// Bound of the error. State either this or `fraction_of_ifd`.
        #[schemars(extend("minimum" = 0, "x-unit" = "length", "x-instead-of" = ["fraction_of_ifd"]))]
        bound: Option<f64>,
        /// Coordinates of the contact that have the error.
        #[serde(default)]
        axis: NoiseAxis,
    },
}

/// Coordinates of the contact that have the error.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseAxis {
    /// All three coordinates of the contact, each with the same distribution of the error.
    #[default]
    Xyz,
    /// Only the height of the contact.
    Z,
}

/// Error of a measured normal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum NormalNoise {
    /// Gaussian angles that tilt the normal about two perpendicular tangents.
    Gaussian {
        /// Standard deviation of each of the two angles.
        #[schemars(extend("minimum" = 0, "maximum" = 180))]
        std_deg: f64,
        /// Constant error: all normals are turned about the y axis by this angle, from +z towards +x. Default: 0.
        /// Positions have no such key, because a constant error of positions moves the patch and does not change its
        /// curvature.
        #[schemars(extend("minimum" = -180, "maximum" = 180))]
        bias_deg: Option<f64>,
    },
}

/// Points at which estimates are compared with the true values. They form a square grid around the middle of the patch.
/// The shape class of a point depends on the signs of the Gaussian and the mean curvature. A curvature whose magnitude
/// is below its threshold counts as zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EvaluateConfig {
    /// Number of points along each side of the grid.
    #[serde(default = "whole::<30>")]
    #[schemars(extend("minimum" = 1, "maximum" = 1000))]
    pub grid: u32,
    /// Half the side length of the square grid.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub half_width: f64,
    /// Threshold for the magnitude of the Gaussian curvature K: smaller values count as zero. It must be at least the
    /// square of `mean_threshold`; otherwise, points could get the impossible shape class K > 0, H = 0, where H is the
    /// mean curvature.
    #[schemars(extend("minimum" = 0, "x-unit" = "1/length^2"))]
    pub gaussian_threshold: f64,
    /// Threshold for the magnitude of the mean curvature: smaller values count as zero.
    #[schemars(extend("minimum" = 0, "x-unit" = "1/length"))]
    pub mean_threshold: f64,
}
