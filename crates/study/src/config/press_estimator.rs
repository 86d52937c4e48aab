//! The estimator of a press.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use strum::IntoStaticStr;

/// The estimator of the curvature. Each kind fits a model of the press to the readings by least squares.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PressEstimatorConfig {
    /// A fit of an elastic half-space. Its displacements are computed at the markers' depth.
    HalfSpace {
        /// Poisson's ratio of the half-space. The default is the ratio of the scene's model, or 0.5 if the model has
        /// none.
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: Option<f64>,
        /// Prior of the indentation. Its settings are keys of the estimator's table.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Priors of the displacements. Their settings are keys of the estimator's table.
        #[serde(flatten)]
        displacements: DisplacementPriors,
    },
    /// A fit of an incompressible layer that is bonded to a rigid core.
    BondedLayer {
        /// Thickness of the layer. The default is the thickness of the scene's model.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: Option<f64>,
        /// Prior of the indentation. Its settings are keys of the estimator's table.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Priors of the displacements. Their settings are keys of the estimator's table.
        #[serde(flatten)]
        displacements: DisplacementPriors,
    },
    /// A fit of an elastic half-space for objects with two different principal curvatures, for example cylinders. Both
    /// curvatures and their directions are fitted. The reported curvature is the mean of the two curvatures.
    Elliptic {
        /// Poisson's ratio of the half-space. The default is the ratio of the scene's model, or 0.5 if the model has
        /// none.
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: Option<f64>,
        /// Prior of the indentation. Its settings are keys of the estimator's table.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Whether the noise of displacements is stated or estimated.
        #[serde(default)]
        noise: NoiseKnown,
    },
    /// The method of Lin and others (2020): a Gaussian is fitted to the normal displacements. The effective radius is R
    /// = c σ²/δ, where σ is the fitted width of the Gaussian, δ is the indentation and c is a constant. The amplitude
    /// of the Gaussian is also fitted. If no indentation is stated, this amplitude is used as δ.
    Gaussian {
        /// The constant c of the method. By default, palpate calibrates c with a simulated press on a plane, without
        /// noise and with the same indentation: c is chosen so that the estimated effective radius on the plane equals
        /// the sensor's radius.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "1"))]
        c: Option<f64>,
        /// Largest distance from the contact at which markers are used in the fit. By default, all markers are used.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        window: Option<f64>,
        /// Prior of the indentation. Its settings are keys of the estimator's table.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Offset of the normal displacements, that is, their value when nothing touches the sensor: zero or fitted.
        #[serde(default)]
        baseline: Baseline,
        /// Whether the noise of displacements is stated or estimated.
        #[serde(default)]
        noise: NoiseKnown,
    },
    /// A fit to the images of the markers: to the centroid, the hue and the size of each marker, before the press and
    /// during the press. If there is a `thickness`, the soft body is a layer bonded to a rigid core, otherwise a
    /// half-space. The fit also uses the errors that the tracker states, and the standard deviations of the sensor's
    /// parameters (`noise.sensor`).
    Image {
        /// Thickness of the layer. The default is the thickness of the scene's model, if this model is a layer and
        /// `poisson` is not stated.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length"))]
        thickness: Option<f64>,
        /// Poisson's ratio of a half-space. The default is the ratio of the scene's model, or 0.5 if the model has
        /// none. If only `poisson` is stated, and not `thickness`, the soft body is a half-space even if the scene's
        /// model is a layer.
        #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
        poisson: Option<f64>,
        /// Prior of the indentation. Its settings are keys of the estimator's table.
        #[serde(flatten)]
        prior: IndentationPrior,
        /// Standard deviation that the estimator assumes for a sideways movement of the object, along x and along y.
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

/// Assumptions of the estimator about the indentation. All press estimators have these settings.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct IndentationPrior {
    /// Whether the estimator receives the indentation or fits it.
    pub indentation: Indentation,
    /// Standard deviation that the estimator assumes for the error of a stated indentation.
    #[schemars(extend("minimum" = 0, "x-unit" = "length"))]
    pub indentation_std: f64,
}

/// Assumptions of the estimator about the displacements. Only the estimators that fit an elastic body to displacements
/// have these settings. The estimator `image` does not have them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct DisplacementPriors {
    /// Offset of the normal displacements, that is, their value when nothing touches the sensor: zero or fitted.
    pub baseline: Baseline,
    /// Standard deviation that the estimator assumes for the gain. The gain is a factor on all normal displacements of
    /// a press; its mean is 1.
    #[schemars(extend("minimum" = 0, "maximum" = 1e100))]
    pub gain_std: f64,
    /// Whether the noise of displacements is stated or estimated.
    pub noise: NoiseKnown,
}

/// The settings that all press estimators share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressPriors {
    /// Whether the estimator receives the indentation or fits it.
    pub indentation: Indentation,
    /// Standard deviation (length) that the estimator assumes for the error of a stated indentation.
    pub indentation_std: f64,
    /// Offset of the normal displacements, that is, their value when nothing touches the sensor: zero or fitted.
    pub baseline: Baseline,
    /// Standard deviation that the estimator assumes for the gain, a factor on all normal displacements of a press.
    /// `None` for the estimator `gaussian`, because its fitted amplitude includes the gain.
    pub gain_std: Option<f64>,
    /// Whether the noise of displacements is stated or estimated.
    pub noise: NoiseKnown,
}

impl PressEstimatorConfig {
    /// The values of the settings that all kinds of press estimators share.
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

    /// Thickness of the layer that the estimator assumes: its own setting or, if it is not stated, the thickness of the
    /// scene's model (`of_model`). `None` if the assumed soft body is not a layer.
    pub fn layer(&self, of_model: Option<f64>) -> Option<f64> {
        match *self {
            Self::BondedLayer { thickness, .. } => thickness.or(of_model),
            Self::Image {
                thickness, poisson, ..
            } => thickness.or(of_model.filter(|_| poisson.is_none())),
            _ => None,
        }
    }

    /// Sets each missing setting whose default is a value of the scene's model to this value. `of_thickness` is the
    /// thickness of the model's layer (`None` without a layer), and `of_poisson` is the model's Poisson's ratio.
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
}

/// Whether the estimator receives the indentation or fits it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Indentation {
    /// The estimator receives the indentation from another source, for example from the pose of a robot.
    #[default]
    Known,
    /// The indentation is unknown. The estimator fits it to the displacements.
    Fitted,
}

/// Offset of the normal displacements, that is, their value when nothing touches the sensor.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Baseline {
    /// The offset of the normal displacements is zero.
    #[default]
    Known,
    /// All normal displacements have the same offset, which is fitted.
    Fitted,
}

/// Source of the noise of the displacements: the scene or the residuals.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NoiseKnown {
    /// The scene states the noise. If the scene has no noise, the noise is estimated from the residuals.
    #[default]
    Stated,
    /// The noise is estimated from the residuals.
    Found,
}
