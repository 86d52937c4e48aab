//! The estimator of a press.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The estimator of the curvature: a least-squares fit of one of these bodies to the readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressEstimatorConfig {
    /// An elastic half-space at the markers' depth.
    HalfSpace {
        /// Poisson's ratio; by default the model's, or 0.5 where that has none.
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: Option<f64>,
        /// Prior of the indentation.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Priors of the displacements.
        #[serde(flatten)]
        displacements: DisplacementPriors,
    },
    /// An incompressible layer bonded to a rigid core.
    BondedLayer {
        /// Thickness of the layer; by default the model's.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: Option<f64>,
        /// Prior of the indentation.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Priors of the displacements.
        #[serde(flatten)]
        displacements: DisplacementPriors,
    },
    /// An elastic half-space under an object with two principal curvatures, for example a cylinder: both are fitted, with their
    /// axis. The reported curvature is their mean.
    Elliptic {
        /// Poisson's ratio; by default the model's, or 0.5 where that has none.
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: Option<f64>,
        /// Prior of the indentation.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Whether the noise of displacements is stated or estimated.
        #[serde(default)]
        noise: NoiseKnown,
    },
    /// The 2020 paper's Gaussian, R = c σ²/δ, fitted to normal displacements. If the indentation is
    /// given, the amplitude is fitted too; otherwise the amplitude is the indentation.
    Gaussian {
        /// The c; by default the value that gives the sensor's own radius on a plane at the same indentation without noise.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "1"))]
        c: Option<f64>,
        /// Only markers within this distance of the contact are fitted; by default all.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        window: Option<f64>,
        /// Prior of the indentation.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Whether displacements are known to be 0 without a press.
        #[serde(default)]
        baseline: Baseline,
        /// Whether the noise of displacements is stated or estimated.
        #[serde(default)]
        noise: NoiseKnown,
    },
    /// The images of the markers on a layer bonded to a rigid core if there is a `thickness`, otherwise on a half-space: fitted to
    /// centroid, hue and size of each marker, at rest and pressed. Its inputs include the errors that the tracker
    /// states and the standard deviations of the sensor parameters (`noise.sensor`).
    Image {
        /// Thickness of the layer; by default the model's, if that has one and `poisson` is left out.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: Option<f64>,
        /// Poisson's ratio of a half-space; by default the model's, or 0.5 where that has none. If it is given and
        /// `thickness` is not, the body is a half-space, also if the model is a layer.
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: Option<f64>,
        /// Prior of the indentation.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Standard deviation that the estimator assumes for a sideways movement of the object, along either axis; of a
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
            prior: IndentationPrior::default(),
            displacements: DisplacementPriors::default(),
        }
    }
}

/// Prior of the indentation, which all press estimators have.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct IndentationPrior {
    /// Whether the indentation is given.
    pub indentation: Indentation,
    /// Standard deviation that the estimator assumes for a given indentation.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub indentation_std: f64,
}

/// Priors of displacements that estimators with an elastic body have.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct DisplacementPriors {
    /// Whether displacements are known to be 0 without a press.
    pub baseline: Baseline,
    /// Standard deviation that the estimator assumes for the factor on all normal displacements.
    #[schemars(extend("minimum" = 0, "maximum" = 1e100))]
    pub gain_std: f64,
    /// Whether the noise of displacements is stated or estimated.
    pub noise: NoiseKnown,
}

/// The settings that all press estimators have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressPriors {
    /// Whether the indentation is given.
    pub indentation: Indentation,
    /// Standard deviation that the estimator assumes for a given indentation, length.
    pub indentation_std: f64,
    /// Whether displacements are known to be 0 without a press.
    pub baseline: Baseline,
    /// Standard deviation of the factor on all normal displacements; `None` for a Gaussian, whose amplitude replaces the
    /// factor.
    pub gain_std: Option<f64>,
    /// Whether the noise of displacements is stated or estimated.
    pub noise: NoiseKnown,
}

impl PressEstimatorConfig {
    /// The settings that all kinds have.
    pub fn priors(&self) -> PressPriors {
        let (prior, displacements) = match *self {
            Self::HalfSpace {
                prior,
                displacements,
                ..
            }
            | Self::BondedLayer {
                prior,
                displacements,
                ..
            } => (prior, displacements),
            Self::Gaussian {
                prior,
                baseline,
                noise,
                ..
            } => {
                let gain_std = 0.0;
                let displacements = DisplacementPriors {
                    baseline,
                    gain_std,
                    noise,
                };
                (prior, displacements)
            }
            Self::Elliptic { prior, noise, .. } => {
                let displacements = DisplacementPriors::default();
                (
                    prior,
                    DisplacementPriors {
                        noise,
                        ..displacements
                    },
                )
            }
            Self::Image { prior, .. } => (prior, DisplacementPriors::default()),
        };
        let has_gain = !matches!(self, Self::Gaussian { .. });
        PressPriors {
            indentation: prior.indentation,
            indentation_std: prior.indentation_std,
            baseline: displacements.baseline,
            gain_std: has_gain.then_some(displacements.gain_std),
            noise: displacements.noise,
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
            Self::HalfSpace { poisson, .. } | Self::Elliptic { poisson, .. } => {
                *poisson = poisson.or(Some(of_poisson));
            }
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
            Self::Elliptic { .. } => "elliptic",
            Self::Gaussian { .. } => "gaussian",
            Self::Image { .. } => "image",
        }
    }
}

/// Whether the indentation is given.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Indentation {
    /// A value from another source, for example the pose of a robot.
    #[default]
    Known,
    /// An unknown that is estimated from the displacements.
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

/// Source of the noise of displacements that the estimator assumes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseKnown {
    /// The noise of the scene; estimated from the residuals if the scene has none.
    #[default]
    Stated,
    /// The residuals.
    Found,
}
