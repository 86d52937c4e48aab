//! How curvature follows from the readings of a press.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How curvature follows from the readings: a least-squares fit of what one of these bodies does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressEstimatorConfig {
    /// An elastic half-space at the markers' depth.
    HalfSpace {
        /// Poisson's ratio; by default the model's, or 0.5 where that has none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: Option<f64>,
        /// Whether the indentation is given.
        #[serde(default)]
        indentation: Indentation,
        /// Standard deviation that the estimator ascribes to an indentation that is given.
        #[serde(default)]
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        indentation_std: f64,
        /// Whether displacements are known to be 0 without a press.
        #[serde(default)]
        baseline: Baseline,
        /// Standard deviation that the estimator ascribes to the factor on all normal displacements.
        #[serde(default)]
        #[schemars(extend("minimum" = 0, "maximum" = 1e100))]
        gain_std: f64,
        /// Whether the noise of displacements is told.
        #[serde(default)]
        noise: NoiseKnown,
    },
    /// An incompressible layer bonded to a rigid core.
    BondedLayer {
        /// Thickness of the layer; by default the model's.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: Option<f64>,
        /// Whether the indentation is given.
        #[serde(default)]
        indentation: Indentation,
        /// Standard deviation that the estimator ascribes to an indentation that is given.
        #[serde(default)]
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        indentation_std: f64,
        /// Whether displacements are known to be 0 without a press.
        #[serde(default)]
        baseline: Baseline,
        /// Standard deviation that the estimator ascribes to the factor on all normal displacements.
        #[serde(default)]
        #[schemars(extend("minimum" = 0, "maximum" = 1e100))]
        gain_std: f64,
        /// Whether the noise of displacements is told.
        #[serde(default)]
        noise: NoiseKnown,
    },
    /// The 2020 paper's Gaussian, R = c σ²/δ, fitted to normal displacements. Its amplitude is fitted too where the
    /// indentation is given, and stands for the indentation where it is not.
    Gaussian {
        /// The c; by default what gives the sensor's own radius on a plane pressed as deep, without noise.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "1"))]
        c: Option<f64>,
        /// Only markers within this distance of the contact count; by default all.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        window: Option<f64>,
        /// Whether the indentation is given.
        #[serde(default)]
        indentation: Indentation,
        /// Standard deviation that the estimator ascribes to an indentation that is given.
        #[serde(default)]
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        indentation_std: f64,
        /// Whether displacements are known to be 0 without a press.
        #[serde(default)]
        baseline: Baseline,
        /// Whether the noise of displacements is told.
        #[serde(default)]
        noise: NoiseKnown,
    },
    /// A layer bonded to a rigid core, where there is a `thickness`, else a half-space, as a camera sees it: fitted to
    /// centroid, hue and size of each marker, at rest and pressed. It is told the errors that the tracker states, and how
    /// roughly the sensor is known (`noise.sensor`).
    Image {
        /// Thickness of the layer; by default the model's, if that has one and `poisson` is left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: Option<f64>,
        /// Poisson's ratio of a half-space; by default the model's, or 0.5 where that has none. Where it is given and
        /// `thickness` is not, the body is a half-space, whatever the model is.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: Option<f64>,
        /// Whether the indentation is given.
        #[serde(default)]
        indentation: Indentation,
        /// Standard deviation that the estimator ascribes to an indentation that is given.
        #[serde(default)]
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        indentation_std: f64,
        /// Standard deviation that the estimator ascribes to a sideways move of the object, along either axis; of a
        /// half-space.
        #[serde(default)]
        #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
        shift_std: f64,
    },
}

impl Default for PressEstimatorConfig {
    fn default() -> Self {
        Self::HalfSpace {
            poisson: None,
            indentation: Indentation::default(),
            indentation_std: 0.0,
            baseline: Baseline::default(),
            gain_std: 0.0,
            noise: NoiseKnown::default(),
        }
    }
}

/// The settings that all press estimators have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressPriors {
    /// Whether the indentation is given.
    pub indentation: Indentation,
    /// Standard deviation ascribed to an indentation that is given, length.
    pub indentation_std: f64,
    /// Whether displacements are known to be 0 without a press.
    pub baseline: Baseline,
    /// Standard deviation ascribed to the factor on all normal displacements; `None` for a Gaussian, whose amplitude replaces
    /// the factor.
    pub gain_std: Option<f64>,
    /// Whether the noise of displacements is told.
    pub noise: NoiseKnown,
}

impl PressEstimatorConfig {
    /// The settings that all kinds have.
    pub const fn priors(&self) -> PressPriors {
        let (indentation, indentation_std) = match *self {
            Self::HalfSpace {
                indentation,
                indentation_std,
                ..
            }
            | Self::BondedLayer {
                indentation,
                indentation_std,
                ..
            }
            | Self::Gaussian {
                indentation,
                indentation_std,
                ..
            }
            | Self::Image {
                indentation,
                indentation_std,
                ..
            } => (indentation, indentation_std),
        };
        let (baseline, gain_std, noise) = match *self {
            Self::HalfSpace {
                baseline,
                gain_std,
                noise,
                ..
            }
            | Self::BondedLayer {
                baseline,
                gain_std,
                noise,
                ..
            } => (baseline, Some(gain_std), noise),
            Self::Gaussian {
                baseline, noise, ..
            } => (baseline, None, noise),
            Self::Image { .. } => (Baseline::Known, Some(0.0), NoiseKnown::Stated),
        };
        PressPriors {
            indentation,
            indentation_std,
            baseline,
            gain_std,
            noise,
        }
    }

    /// Thickness of the assumed layer: its own, otherwise the model's; `None` for other bodies.
    pub fn layer(&self, of_model: Option<f64>) -> Option<f64> {
        match *self {
            Self::BondedLayer { thickness, .. } => thickness.or(of_model),
            Self::Image {
                thickness, poisson, ..
            } => thickness.or(of_model.filter(|_| poisson.is_none())),
            _ => None,
        }
    }

    /// Sets the settings that would default to the model's, to the thickness (if any) and Poisson's ratio of this model.
    pub(super) fn keep(&mut self, of_thickness: Option<f64>, of_poisson: f64) {
        match self {
            Self::HalfSpace { poisson, .. } => *poisson = poisson.or(Some(of_poisson)),
            Self::BondedLayer { thickness, .. } => *thickness = thickness.or(of_thickness),
            Self::Image {
                thickness, poisson, ..
            } => {
                *thickness = thickness.or(of_thickness.filter(|_| poisson.is_none()));
                if thickness.is_none() {
                    *poisson = poisson.or(Some(of_poisson));
                }
            }
            Self::Gaussian { .. } => {}
        }
    }

    /// Name of the kind, as configs have it.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::HalfSpace { .. } => "half-space",
            Self::BondedLayer { .. } => "bonded-layer",
            Self::Gaussian { .. } => "gaussian",
            Self::Image { .. } => "image",
        }
    }
}

/// Whether the indentation is given.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Indentation {
    /// A value that something else tells, a robot's pose say.
    #[default]
    Known,
    /// An unknown, which follows from the displacements.
    Fitted,
}

/// Reading of normal displacements without a press.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Baseline {
    /// Zero.
    #[default]
    Known,
    /// An offset that is the same for all normal displacements, which is fitted.
    Fitted,
}

/// Source of the noise of displacements that the estimator reckons with.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseKnown {
    /// The noise of the scene; found from the residuals where the scene has none.
    #[default]
    Stated,
    /// The residuals.
    Found,
}
