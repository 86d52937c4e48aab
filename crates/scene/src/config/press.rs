//! The config of a press: a soft spherical fingertip with markers under its skin is pressed onto an object once.

mod estimator;
mod layout;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use estimator::{Baseline, Indentation, NoiseKnown, PressEstimatorConfig};
pub use layout::{LayoutConfig, LayoutTable, NamedLayout};

/// A sensor is pressed onto an object, and the object's curvature is estimated from how its markers move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressConfig {
    /// What presses.
    pub probe: PressProbeConfig,
    /// What is pressed on.
    pub object: PressObjectConfig,
    /// How deep, and with which part of the skin.
    pub motion: PressMotionConfig,
    /// What the press does to the markers.
    #[serde(default)]
    pub model: PressModelConfig,
    /// What the markers' displacements are read with.
    #[serde(default)]
    pub sensor: PressSensorConfig,
    /// Errors of the readings.
    #[serde(default)]
    pub noise: PressNoiseConfig,
    /// How curvature follows from the readings.
    #[serde(default)]
    pub estimator: PressEstimatorConfig,
}

impl PressConfig {
    pub(super) fn check(&self) -> Result<(), (&'static str, &'static str)> {
        let PressProbeConfig::MarkerSphere { marker_depth, .. } = self.probe;
        let of_model = self.model.thickness();
        if of_model.is_some_and(|thickness| marker_depth > thickness) {
            return Err((
                "scene.probe.marker_depth",
                "the markers lie below the layer: must be at most `scene.model.thickness`",
            ));
        }
        let PressEstimatorConfig::BondedLayer { thickness, .. } = self.estimator else {
            return Ok(());
        };
        match thickness.or(of_model) {
            None => Err((
                "scene.estimator",
                "`thickness` is missing, and the model has no layer to take it from",
            )),
            Some(thickness) if marker_depth > thickness => Err((
                "scene.estimator.thickness",
                "the layer ends above the markers: must be at least `scene.probe.marker_depth`",
            )),
            Some(_) => Ok(()),
        }
    }
}

/// What presses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressProbeConfig {
    /// A soft sphere with markers under its skin.
    MarkerSphere {
        /// Radius of the skin.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
        /// How far under the skin the markers lie, less than the radius; where a marker is made of two discs, the mean of their depths.
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        marker_depth: f64,
        /// Where the markers lie along the skin.
        #[serde(default)]
        layout: LayoutConfig,
    },
}

/// What is pressed on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressObjectConfig {
    /// The outside of a sphere.
    Sphere {
        /// Its radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
    /// The inside of a sphere. One that is not wider than the sensor is not touched in one point: trials fail.
    Dish {
        /// Its radius, without a sign.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        radius: f64,
    },
    /// A plane.
    Plane {},
}

/// How deep the press goes, and with which part of the skin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressMotionConfig {
    /// The approach of the two bodies since first touch.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
    pub indentation: f64,
    /// Where on the skin the contact lies: polar angle from the apex, from 0 to 180, and azimuth from x.
    #[serde(default)]
    pub contact_deg: [f64; 2],
}

/// What the press does to the markers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressModelConfig {
    /// Hertz contact, seen at the skin's surface whatever the markers' depth.
    Hertz {
        /// Poisson's ratio of the soft body.
        #[serde(default = "half")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: f64,
    },
    /// Hertz contact on an elastic half-space, in closed form at the markers' depth.
    HalfSpace {
        /// Poisson's ratio of the soft body.
        #[serde(default = "half")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: f64,
    },
    /// An incompressible layer bonded to a rigid core; the contact is solved for.
    BondedLayer {
        /// Thickness of the layer, at most the radius of the sensor.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: f64,
    },
}

fn half() -> f64 {
    0.5
}

impl Default for PressModelConfig {
    fn default() -> Self {
        Self::HalfSpace { poisson: half() }
    }
}

impl PressModelConfig {
    /// Thickness of the layer, if there is one.
    pub(crate) fn thickness(&self) -> Option<f64> {
        match *self {
            Self::BondedLayer { thickness } => Some(thickness),
            Self::Hertz { .. } | Self::HalfSpace { .. } => None,
        }
    }
}

/// What the markers' displacements are read with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressSensorConfig {
    /// Every marker's displacement is read, without a camera in between.
    Direct {
        /// Whether displacements along the skin are read too.
        #[serde(default = "yes")]
        tangential: bool,
        /// How many readings are averaged, which divides the noise of displacements by its square root.
        #[serde(default = "one")]
        #[schemars(extend("minimum" = 1))]
        frames: u32,
    },
}

fn yes() -> bool {
    true
}

fn one() -> u32 {
    1
}

impl Default for PressSensorConfig {
    fn default() -> Self {
        Self::Direct {
            tangential: yes(),
            frames: one(),
        }
    }
}

/// Errors of the readings; what is absent has none.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PressNoiseConfig {
    /// Error of each marker's displacement along the normal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal_displacement: Option<LengthNoise>,
    /// Error of each component of each marker's displacement along the skin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tangential_displacement: Option<LengthNoise>,
    /// Error of the known indentation that the estimator is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub indentation: Option<LengthNoise>,
    /// Error of a factor, which should be 1, on all normal displacements of a press.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<GainNoise>,
    /// Markers that err by more, others in every trial.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrong_markers: Option<WrongMarkers>,
}

/// Error of a length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum LengthNoise {
    /// Gaussian with mean 0.
    Gaussian {
        /// Standard deviation.
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        std: f64,
    },
}

/// Error of a factor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum GainNoise {
    /// Gaussian with mean 0.
    Gaussian {
        /// Standard deviation, a share of the displacement.
        #[schemars(extend("minimum" = 0, "x-unit" = "1"))]
        std: f64,
    },
}

/// Markers that are taken for others, say.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WrongMarkers {
    /// How many, drawn anew in every trial.
    pub count: u32,
    /// Standard deviation of their Gaussian error on top of the others': of the normal displacement and of both tangential components.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub std: f64,
}
