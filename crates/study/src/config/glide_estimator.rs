//! The estimator of a glide.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use strum::IntoStaticStr;

use super::schema::{number, whole};

/// The estimator of the patch's surface and curvature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum GlideEstimatorConfig {
    /// One bicubic spline, fitted to the heights of the contacts and, if there are normals, to the slopes. A penalty on
    /// the third partial derivatives of the height makes it smooth.
    Penalised {
        /// Number of knot intervals of the spline along each side of the patch. By default, palpate computes it from
        /// the number of contacts.
        #[schemars(extend("minimum" = 1, "maximum" = 24))]
        intervals: Option<u32>,
        /// Method that chooses the weight of the smoothness penalty.
        #[serde(default)]
        criterion: CriterionName,
        /// Factor by which robust cross validation multiplies the effective degrees of freedom of the spline. A larger
        /// factor gives a smoother surface; 1 gives plain cross validation. Only the criterion `robust-gcv` has this
        /// setting.
        #[serde(default = "gamma")]
        #[schemars(extend("minimum" = 1, "maximum" = 100))]
        gamma: f64,
        /// Noise of the contacts, as the user states it.
        #[serde(flatten)]
        noise: StatedNoise,
    },
    /// The method of Charlebois, Gupta and Payandeh (1996): two smoothing splines are fitted one after the other. The
    /// second spline is also fitted to points on the tangents at the contacts. In the settings of this method, lengths
    /// are in units of the inter-finger distance.
    TwoPass {
        /// Degree of the first spline in both directions.
        #[serde(default = "whole::<2>")]
        #[schemars(extend("minimum" = 1, "maximum" = 5))]
        first_degree: u32,
        /// Degree of the second spline in both directions.
        #[serde(default = "whole::<3>")]
        #[schemars(extend("minimum" = 1, "maximum" = 5))]
        second_degree: u32,
        /// Factor by which all residuals of the splines are multiplied before they are squared.
        #[serde(default = "number::<100>")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        weight: f64,
        /// Smoothing limit of the first spline: the largest sum of its squared weighted residuals that is allowed. A
        /// larger limit gives a smoother spline.
        #[serde(default = "number::<1000>")]
        #[schemars(extend("minimum" = 0))]
        smoothing: f64,
        /// Smoothing limit of the second spline: the largest sum of its squared weighted residuals that is allowed. A
        /// larger limit gives a smoother spline.
        #[serde(default = "number::<1000>")]
        #[schemars(extend("minimum" = 0))]
        second_smoothing: f64,
        /// Distance between a contact and the points that the second spline uses on a tangent at this contact. There is
        /// one point on each side of the contact.
        #[serde(default = "twentieth")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        tangent_step: f64,
        /// Source of the normals from which the tangents are computed.
        #[serde(default)]
        normals: NormalsOf,
        /// Number of splines that are fitted one after the other. If it is 1, only the first spline is fitted.
        #[serde(default = "whole::<2>")]
        #[schemars(extend("minimum" = 1, "maximum" = 2))]
        passes: u32,
    },
    /// A quadric, fitted to the contacts by weighted least squares.
    Quadric(StatedNoise),
    /// A plane, fitted to the contacts that are not outliers.
    Plane(StatedNoise),
    /// A sphere, fitted to the contacts that are not outliers. The contacts may lie anywhere on the sphere.
    Sphere(StatedNoise),
    /// A circular cylinder, fitted to the contacts that are not outliers. The contacts may lie anywhere on the
    /// cylinder.
    Cylinder(StatedNoise),
    /// Chooses the most probable shape of the surface under the contacts: a plane, a sphere, a cylinder, or none of
    /// these shapes.
    Shape(StatedNoise),
}

/// Noise of the contacts, as the user states it. If it is not stated, the estimator computes it from the contacts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StatedNoise {
    /// Standard deviation of the error of a contact's position along each axis; by default estimated from the contacts.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length", "x-instead-of" = ["position_fraction_of_ifd"]))]
    pub position_std: Option<f64>,
    /// Standard deviation of the error of a contact's position along each axis, as a fraction of the inter-finger
    /// distance. State either this or `position_std`.
    #[schemars(extend("exclusiveMinimum" = 0, "x-instead-of" = ["position_std"]))]
    pub position_fraction_of_ifd: Option<f64>,
    /// Standard deviation of the error of a normal, that is, of the angle by which it is tilted about each of two
    /// perpendicular tangents; by default estimated from the contacts.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 90))]
    pub normal_std_deg: Option<f64>,
}

fn gamma() -> f64 {
    1.4
}

fn twentieth() -> f64 {
    0.05
}

impl GlideEstimatorConfig {
    /// Checks the rules that involve several settings of the estimator.
    ///
    /// # Errors
    /// A message, if `gamma` is stated with a criterion that does not use it.
    pub fn check(&self) -> Result<(), &'static str> {
        match *self {
            Self::Penalised {
                criterion: CriterionName::Gcv | CriterionName::Reml,
                gamma: given,
                ..
            } if given != gamma() => Err(
                "only criterion \"robust-gcv\" has a gamma; leave it out with \"gcv\" and \"reml\"",
            ),
            _ => Ok(()),
        }
    }

    /// The settings in which the user states the noise; `None` for an estimator that does not use the noise.
    pub const fn noise(&mut self) -> Option<&mut StatedNoise> {
        match self {
            Self::Penalised { noise, .. }
            | Self::Quadric(noise)
            | Self::Plane(noise)
            | Self::Sphere(noise)
            | Self::Cylinder(noise)
            | Self::Shape(noise) => Some(noise),
            Self::TwoPass { .. } => None,
        }
    }

    /// The estimator with its position noise as a length. If the noise is stated as a fraction of the inter-finger
    /// distance, it is multiplied by this distance.
    #[must_use]
    pub fn with_length_noise(mut self, inter_finger_distance: f64) -> Self {
        if let Some(noise) = self.noise()
            && let Some(fraction) = noise.position_fraction_of_ifd.take()
        {
            noise.position_std = Some(fraction * inter_finger_distance);
        }
        self
    }
}

impl Default for GlideEstimatorConfig {
    fn default() -> Self {
        Self::Penalised {
            intervals: None,
            criterion: CriterionName::default(),
            gamma: gamma(),
            noise: StatedNoise::default(),
        }
    }
}

/// Method that chooses the weight of the smoothness penalty.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CriterionName {
    /// Generalised cross validation in which each effective degree of freedom counts `gamma` times.
    #[default]
    RobustGcv,
    /// Generalised cross validation.
    Gcv,
    /// Restricted maximum likelihood.
    Reml,
}

/// Source of the normals from which the tangents of the second spline are computed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NormalsOf {
    /// The normals of the readings. If the readings have no normals, the normals of the first spline.
    #[default]
    Measured,
    /// The normals of the first spline.
    FirstFit,
}
