//! The estimator of a press.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The estimator of the curvature: a least-squares fit of a model to the readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressEstimatorConfig {
    /// A fit of an elastic half-space, with displacements at the markers' depth.
    HalfSpace {
        /// Poisson's ratio of the half-space. The default is the ratio of the scene's model, or 0.5 if the model has
        /// none.
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: Option<f64>,
        /// Prior of the indentation.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Priors of the displacements.
        #[serde(flatten)]
        displacements: DisplacementPriors,
    },
    /// A fit of an incompressible layer that is bonded to a rigid core.
    BondedLayer {
        /// Thickness of the layer. The default is the thickness of the scene's model.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: Option<f64>,
        /// Prior of the indentation.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Priors of the displacements.
        #[serde(flatten)]
        displacements: DisplacementPriors,
    },
    /// A fit of an elastic half-space under an object with two principal curvatures, for example a cylinder. Both
    /// curvatures and the direction of the axis are fitted. The reported curvature is their mean.
    Elliptic {
        /// Poisson's ratio of the half-space. The default is the ratio of the scene's model, or 0.5 if the model has
        /// none.
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: Option<f64>,
        /// Prior of the indentation.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Whether the noise of displacements is stated or estimated.
        #[serde(default)]
        noise: NoiseKnown,
    },
    /// The 2020 paper's Gaussian, fitted to normal displacements. From its width σ, the indentation δ and the constant
    /// c follows the effective radius R = c σ²/δ. If δ is stated, the amplitude of the Gaussian is fitted too;
    /// otherwise the fitted amplitude is used as δ.
    Gaussian {
        /// The constant c of the Gaussian. By default, c is calibrated by a press on a plane without noise, at the same
        /// indentation: with this c, the estimated effective radius is the sensor's own radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "1"))]
        c: Option<f64>,
        /// Largest distance from the contact at which markers are used in the fit; by default all markers are used.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        window: Option<f64>,
        /// Prior of the indentation.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Offset of the normal displacements, that is, their reading without a press: zero or fitted.
        #[serde(default)]
        baseline: Baseline,
        /// Whether the noise of displacements is stated or estimated.
        #[serde(default)]
        noise: NoiseKnown,
    },
    /// A fit to the images of the markers: to centroid, hue and size of each marker, at rest and pressed. The soft body
    /// is a layer bonded to a rigid core if there is a `thickness`, otherwise a half-space. The inputs include the
    /// errors that the tracker states and the standard deviations of the sensor's parameters (`noise.sensor`).
    Image {
        /// Thickness of the layer. The default is the thickness of the scene's model, if the model has a layer and
        /// `poisson` is not stated.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: Option<f64>,
        /// Poisson's ratio of a half-space. The default is the ratio of the scene's model, or 0.5 if the model has
        /// none. If `poisson` is stated and `thickness` is not, the soft body is a half-space even if the model is a
        /// layer.
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: Option<f64>,
        /// Prior of the indentation.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Standard deviation that the estimator assumes for a sideways movement of the object, along each of two axes.
        /// Only for a half-space.
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

/// Prior of the indentation. It is a setting of all press estimators.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct IndentationPrior {
    /// Whether the indentation is stated or fitted.
    pub indentation: Indentation,
    /// Standard deviation that the estimator assumes for a stated indentation.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub indentation_std: f64,
}

/// Priors of the displacements. They are settings of the estimators with an elastic body.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct DisplacementPriors {
    /// Offset of the normal displacements, that is, their reading without a press: zero or fitted.
    pub baseline: Baseline,
    /// Standard deviation that the estimator assumes for the gain, that is, for the factor on all normal displacements.
    #[schemars(extend("minimum" = 0, "maximum" = 1e100))]
    pub gain_std: f64,
    /// Whether the noise of displacements is stated or estimated.
    pub noise: NoiseKnown,
}

/// The settings that all press estimators share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressPriors {
    /// Whether the indentation is stated or fitted.
    pub indentation: Indentation,
    /// Standard deviation that the estimator assumes for a stated indentation, length.
    pub indentation_std: f64,
    /// Offset of the normal displacements, that is, their reading without a press: zero or fitted.
    pub baseline: Baseline,
    /// Standard deviation of the gain, that is, of the factor on all normal displacements. `None` for a Gaussian,
    /// because its fitted amplitude replaces the gain.
    pub gain_std: Option<f64>,
    /// Whether the noise of displacements is stated or estimated.
    pub noise: NoiseKnown,
}

impl PressEstimatorConfig {
    /// The settings that all kinds of press estimators share.
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

    /// Thickness of the layer that the estimator assumes: its own setting or, without this setting, the thickness of
    /// the model (`of_model`). `None` for soft bodies that are not a layer.
    pub fn layer(&self, of_model: Option<f64>) -> Option<f64> {
        match *self {
            Self::BondedLayer { thickness, .. } => thickness.or(of_model),
            Self::Image {
                thickness, poisson, ..
            } => thickness.or(of_model.filter(|_| poisson.is_none())),
            _ => None,
        }
    }

    /// Sets the settings whose default is the model's value. `of_thickness` is the model's thickness, if the model has
    /// a layer; `of_poisson` is its Poisson's ratio.
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

    /// Name of the kind, as configs state it.
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

/// Whether the indentation is stated or fitted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Indentation {
    /// The indentation is stated; its value comes from another source, for example the pose of a robot.
    #[default]
    Known,
    /// The indentation is unknown, and is fitted to the displacements.
    Fitted,
}

/// Offset of the normal displacements, that is, their reading without a press.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Baseline {
    /// The offset is zero.
    #[default]
    Known,
    /// The offset is the same for all normal displacements, and is fitted.
    Fitted,
}

/// Source of the noise of displacements that the estimator assumes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseKnown {
    /// The noise that the scene states. If the scene has no noise, it is estimated from the residuals.
    #[default]
    Stated,
    /// The noise is estimated from the residuals.
    Found,
}
