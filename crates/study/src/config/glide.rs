//! The config of a glide: fingers slide over a patch of an object, and the patch's curvature is estimated.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::glide_estimator::GlideEstimatorConfig;
use super::number_default::{number, whole};
use super::object::ObjectConfig;
use super::roll::PadLayout;

/// Fingers slide over an object in parallel vertical planes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GlideConfig {
    /// The fingertip that touches.
    pub probe: FingertipConfig,
    /// The surface that is explored.
    pub object: ObjectConfig,
    /// The middle of the patch: x and y of the object's frame. By default the origin or the top.
    #[schemars(extend("x-unit" = "length"))]
    pub object_contact: Option<[f64; 2]>,
    /// Paths of the fingers and contacts along them.
    pub motion: GlideMotionConfig,
    /// How contacts are computed.
    #[serde(default)]
    pub model: GlideModelConfig,
    /// The sensor that reads the contacts.
    #[serde(default)]
    pub sensor: GlideSensorConfig,
    /// Errors of the readings.
    #[serde(default)]
    pub noise: GlideNoiseConfig,
    /// The estimator of the patch.
    #[serde(default)]
    pub estimator: GlideEstimatorConfig,
    /// Places at which estimates are compared with the truth.
    pub evaluate: EvaluateConfig,
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
    /// A point, which is itself the contact point.
    Point {},
    /// A ball. On a slope its contact point is not its lowest point.
    Sphere {
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
}

/// Paths of the fingers and contacts along them. Each finger goes along +x in a plane of constant y.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GlideMotionConfig {
    /// Positions of the fingers' planes: y from the middle of the patch.
    #[schemars(extend("minItems" = 1, "x-unit" = "length"))]
    pub finger_positions: Vec<f64>,
    /// The distance between neighbouring fingers. It is a unit of noise, and the unit of the settings of two-pass.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub inter_finger_distance: f64,
    /// How far each finger slides along x, its first and last contact included.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub patch_length: f64,
    /// Contacts of each finger, equally spaced and centred on the patch.
    #[schemars(extend("minimum" = 1, "maximum" = 100_000))]
    pub contacts_per_finger: u32,
}

/// How the contacts of the fingertips are computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum GlideModelConfig {
    /// The closed form if there is one, otherwise Newton's method.
    Auto {
        /// Largest error of a contact's place, relative to the tip's radius.
        #[serde(default = "tolerance")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        tolerance: f64,
    },
    /// The closed form: of points, and of round tips on planes, spheres, dishes and cylinders.
    ClosedForm {},
    /// Newton's method on the offset surface of a round tip.
    Newton {
        /// Largest error of a contact's place, relative to the tip's radius.
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
    /// No error.
    Ideal {
        /// Whether normals are sensed too.
        #[serde(default = "yes")]
        normals: bool,
        /// The point that is reported.
        #[serde(default)]
        reports: Reports,
    },
    /// An array of pads around the lowest point of a round tip. The pad nearest to the contact reports its own
    /// centre. The direction to it from the tip's centre gives the contact and the normal, so both are quantised.
    Pads {
        /// Distance between neighbouring pads.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        pitch: f64,
        /// How the pads are laid out.
        #[serde(default)]
        layout: PadLayout,
        /// Polar angle of the last pad, from the middle of the array.
        #[serde(default = "number::<90>")]
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 180))]
        cap_deg: f64,
        /// Whether normals are reported too.
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

/// Which point of a fingertip an ideal sensor reports.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Reports {
    /// The contact, wherever it is on the tip.
    #[default]
    Contact,
    /// The lowest point of the tip. The estimator computes the contact from it, the tip's radius and the normal. The normal
    /// is sensed, or else that of a first fit to the tips' centres.
    LowestPoint,
}

/// Errors of the readings; a missing one is 0.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GlideNoiseConfig {
    /// Error of the contacts' coordinates.
    pub position: Option<PositionNoise>,
    /// Error of the normals.
    pub normal: Option<NormalNoise>,
}

/// Error of a contact's coordinates, each drawn alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PositionNoise {
    /// Gaussian with mean 0.
    Gaussian {
        /// The standard deviation as a fraction of the inter-finger distance. This or `std` is given.
        #[schemars(extend("minimum" = 0, "x-instead-of" = ["std"]))]
        fraction_of_ifd: Option<f64>,
        /// The standard deviation. This or `fraction_of_ifd` is given.
        #[schemars(extend("minimum" = 0, "x-unit" = "length", "x-instead-of" = ["fraction_of_ifd"]))]
        std: Option<f64>,
        /// Which coordinates err.
        #[serde(default)]
        axis: NoiseAxis,
    },
    /// Uniform between −bound and +bound.
    Uniform {
        /// The bound as a fraction of the inter-finger distance. This or `bound` is given.
        #[schemars(extend("minimum" = 0, "x-instead-of" = ["bound"]))]
        fraction_of_ifd: Option<f64>,
        /// The bound. This or `fraction_of_ifd` is given.
        #[schemars(extend("minimum" = 0, "x-unit" = "length", "x-instead-of" = ["fraction_of_ifd"]))]
        bound: Option<f64>,
        /// Which coordinates err.
        #[serde(default)]
        axis: NoiseAxis,
    },
}

/// Which coordinates err.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseAxis {
    /// All three, alike.
    #[default]
    Xyz,
    /// The height alone.
    Z,
}

/// Error of a normal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum NormalNoise {
    /// A tilt by Gaussian angles about two perpendicular tangents.
    Gaussian {
        /// Standard deviation of either angle.
        #[schemars(extend("minimum" = 0, "maximum" = 180))]
        std_deg: f64,
    },
}

/// Places at which estimates are compared with the truth, a square grid around the middle of the patch, and thresholds
/// below which curvatures count as zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EvaluateConfig {
    /// Places along each side.
    #[serde(default = "whole::<30>")]
    #[schemars(extend("minimum" = 1, "maximum" = 1000))]
    pub grid: u32,
    /// Half the side of the square, in x and y.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub half_width: f64,
    /// Threshold below which the Gaussian curvature counts as zero; at least the square of the mean threshold.
    #[schemars(extend("minimum" = 0, "x-unit" = "1/length^2"))]
    pub gaussian_threshold: f64,
    /// Threshold below which the mean curvature counts as zero.
    #[schemars(extend("minimum" = 0, "x-unit" = "1/length"))]
    pub mean_threshold: f64,
}
