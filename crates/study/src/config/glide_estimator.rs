//! How the shape of a patch follows from readings.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the patch follows from the readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum GlideEstimatorConfig {
    /// One bicubic spline through heights and slopes, with a penalty on its third derivatives.
    Penalised {
        /// Intervals of the spline along each side; by default as many as the contacts bear.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("minimum" = 1, "maximum" = 24))]
        intervals: Option<u32>,
        /// How the weight of the penalty is chosen.
        #[serde(default)]
        criterion: CriterionName,
        /// How much stronger than plain cross validation the robust one smooths; only used by that, and left at its default with others.
        #[serde(default = "gamma")]
        #[schemars(extend("minimum" = 1, "maximum" = 100))]
        gamma: f64,
        /// Standard deviation of a position along each axis; by default found from the contacts.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length", "x-instead-of" = ["position_fraction_of_ifd"]))]
        position_std: Option<f64>,
        /// Standard deviation of a position along each axis as a fraction of the inter-finger distance, instead of
        /// `position_std`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "x-instead-of" = ["position_std"]))]
        position_fraction_of_ifd: Option<f64>,
        /// Standard deviation of a normal's tilt about each tangent; by default found from the contacts.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 90))]
        normal_std_deg: Option<f64>,
    },
    /// The method of the 1996 paper: a smoothing spline, and a second one through it and its tangents. Lengths are
    /// counted in inter-finger distances.
    TwoPass {
        /// Degree of the first spline in both directions.
        #[serde(default = "two")]
        #[schemars(extend("minimum" = 1, "maximum" = 5))]
        first_degree: u32,
        /// Degree of the second spline.
        #[serde(default = "three")]
        #[schemars(extend("minimum" = 1, "maximum" = 5))]
        second_degree: u32,
        /// Factor on the residuals.
        #[serde(default = "hundred")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        weight: f64,
        /// Sum of squared weighted residuals that the first spline aims at.
        #[serde(default = "thousand")]
        #[schemars(extend("minimum" = 0))]
        smoothing: f64,
        /// Sum of squared weighted residuals that the second spline aims at.
        #[serde(default = "thousand")]
        #[schemars(extend("minimum" = 0))]
        second_smoothing: f64,
        /// Step to either side along the tangent.
        #[serde(default = "twentieth")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        tangent_step: f64,
        /// Whose normals the tangents are of.
        #[serde(default)]
        normals: NormalsOf,
        /// How many splines are fitted: 1 stops after the first.
        #[serde(default = "two")]
        #[schemars(extend("minimum" = 1, "maximum" = 2))]
        passes: u32,
    },
    /// The weighted least-squares quadric.
    Quadric {
        /// Standard deviation of a position along each axis; by default found from the contacts.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "length", "x-instead-of" = ["position_fraction_of_ifd"]))]
        position_std: Option<f64>,
        /// Standard deviation of a position along each axis as a fraction of the inter-finger distance, instead of
        /// `position_std`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "x-instead-of" = ["position_std"]))]
        position_fraction_of_ifd: Option<f64>,
        /// Standard deviation of a normal's tilt about each tangent; by default found from the contacts.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 90))]
        normal_std_deg: Option<f64>,
    },
}

fn gamma() -> f64 {
    1.4
}

fn two() -> u32 {
    2
}

fn three() -> u32 {
    3
}

fn hundred() -> f64 {
    100.0
}

fn thousand() -> f64 {
    1000.0
}

fn twentieth() -> f64 {
    0.05
}

impl GlideEstimatorConfig {
    /// Rules that join several settings; the error is in words.
    ///
    /// # Errors
    /// A gamma beside a criterion that has none.
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

    /// The settings of stated noise: of positions as a length and as a fraction of the inter-finger distance, and of
    /// normals; `None` for a method without them.
    const fn noise(&mut self) -> Option<[&mut Option<f64>; 3]> {
        match self {
            Self::Penalised {
                position_std,
                position_fraction_of_ifd,
                normal_std_deg,
                ..
            }
            | Self::Quadric {
                position_std,
                position_fraction_of_ifd,
                normal_std_deg,
            } => Some([position_std, position_fraction_of_ifd, normal_std_deg]),
            Self::TwoPass { .. } => None,
        }
    }

    /// The estimator with a noise of positions that is a fraction of the inter-finger distance as a length.
    #[must_use]
    pub fn with_length_noise(mut self, inter_finger_distance: f64) -> Self {
        if let Some([position_std, fraction, _]) = self.noise()
            && let Some(fraction) = fraction.take()
        {
            *position_std = Some(fraction * inter_finger_distance);
        }
        self
    }

    /// The estimator without its stated noise, and this noise: of positions as a length, and of normals.
    #[must_use]
    pub fn without_noise(mut self) -> (Self, [Option<f64>; 2]) {
        let stated = self
            .noise()
            .map(|[position, _, normal]| [position.take(), normal.take()]);
        (self, stated.unwrap_or_default())
    }

    /// Noise of positions as a fraction of the inter-finger distance, where it is stated so.
    pub fn position_fraction_of_ifd(&self) -> Option<f64> {
        self.clone().noise().and_then(|[_, fraction, _]| *fraction)
    }

    /// Name of the kind, as configs have it.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Penalised { .. } => "penalised",
            Self::TwoPass { .. } => "two-pass",
            Self::Quadric { .. } => "quadric",
        }
    }
}

impl Default for GlideEstimatorConfig {
    fn default() -> Self {
        Self::Penalised {
            intervals: None,
            criterion: CriterionName::default(),
            gamma: gamma(),
            position_std: None,
            position_fraction_of_ifd: None,
            normal_std_deg: None,
        }
    }
}

/// How the weight of a penalty is chosen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CriterionName {
    /// Generalised cross validation in which every unknown counts gamma times.
    #[default]
    RobustGcv,
    /// Generalised cross validation.
    Gcv,
    /// Restricted maximum likelihood.
    Reml,
}

/// Whose normals the tangents of the second spline are of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NormalsOf {
    /// The readings'; the first fit's where they have none.
    #[default]
    Measured,
    /// The first fit's.
    FirstFit,
}
