//! The top level of a study's config, and the types that all scenes share.

use super::glide::{GlideConfig, GlideModelConfig};
use super::marker_sensor::BareFingertipConfig;
use super::number_default::count;
use super::plot::PlotConfig;
use super::press::{PressConfig, PressModelConfig};
use super::roll::{RollConfig, RollModelConfig};
use super::sweep::SweepConfig;
use super::validate::NAME;
use crate::readings::ColumnNames;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A study: one scene, the axes along which it is varied, and the plots drawn from its table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyConfig {
    /// Name of the study and of its folder of results: lower-case words joined by hyphens.
    #[schemars(extend("pattern" = NAME, "maxLength" = 100))]
    pub name: String,
    /// The question that the study answers.
    #[serde(default)]
    pub title: String,
    /// Origin of the study, e.g. a section and a figure of a paper.
    #[serde(default)]
    pub source: String,
    /// The unit of every length in the config and in its results.
    #[serde(default)]
    pub length_unit: LengthUnit,
    /// Seed of all random draws.
    #[serde(default)]
    pub seed: u64,
    /// Trials per cell; a scene without noise runs one.
    #[serde(default = "count::<10_000>")]
    #[schemars(extend("minimum" = 1))]
    pub trials: u64,
    /// Rule that ends the trials of a cell, instead of a number of trials.
    pub stop: Option<StopConfig>,
    /// Numbers of the published claims that are scored from this study's tables.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub claims: Vec<u32>,
    /// Results that the study writes.
    #[serde(default = "cells_only")]
    pub outputs: Vec<Output>,
    /// Version of the crate that wrote a resolved config; ignored when read.
    pub crate_version: Option<String>,
    /// Names of the columns of recorded readings that `palpate estimate --like` takes with this study, by palpate's own
    /// names: `x = "Finger X [m]"`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub columns: ColumnNames,
    /// The scene: the bodies in contact, the model, the sensor and the estimator.
    pub scene: SceneConfig,
    /// Axes along which fields are varied; axes multiply, the first varies slowest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sweep: Vec<SweepConfig>,
    /// Plots of the study's table. Without any there is one: the relative rms error of the object's curvature over the
    /// first swept field, with a line per value of the second and a panel per value of the third.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plot: Vec<PlotConfig>,
}

/// Rule by which a cell has had enough trials: a statistic of a quantity is known to a relative standard error.
///
/// It is looked at after 1, 2, 4, 8 … blocks of 1,024 trials, in the order of their numbers. The error is one over trials:
/// several observations of one trial, as at all places of a patch, count as one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StopConfig {
    /// Relative standard error at which the statistic is known well enough.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0))]
    pub relative_standard_error: f64,
    /// Quantity that is watched, as the results name it; by default the first of the scene.
    pub quantity: Option<String>,
    /// Statistic that is watched.
    #[serde(default)]
    pub statistic: StopStatistic,
    /// Fewest trials per cell.
    #[serde(default = "count::<1024>")]
    #[schemars(extend("minimum" = 1))]
    pub min_trials: u64,
    /// Most trials per cell.
    #[schemars(extend("minimum" = 1))]
    pub max_trials: u64,
}

/// Statistic by which a cell is watched.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StopStatistic {
    /// Mean of the estimates.
    Mean,
    /// Root of the mean squared error.
    #[default]
    RmsError,
    /// Mean magnitude of the error.
    MeanAbsError,
}

fn cells_only() -> Vec<Output> {
    vec![Output::Cells]
}

/// A scene, by the way in which its bodies touch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
#[expect(clippy::large_enum_variant, reason = "a study has one scene")]
pub enum SceneConfig {
    /// A probe rolls on an object.
    Roll(RollConfig),
    /// Fingers slide over a patch of an object.
    Glide(GlideConfig),
    /// A soft sphere with markers is pressed onto an object.
    Press(PressConfig),
    /// A sensor with markers by itself, which touches nothing: how much its skin is strained by folding it from its flat
    /// pattern (`greatest_fold_strain`, `rms_fold_strain`), and how large a marker looks (`marker_area`). Nothing is random.
    Fingertip(BareFingertipConfig),
}

impl SceneConfig {
    /// Name of the kind, as configs have it.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Roll(_) => "roll",
            Self::Glide(_) => "glide",
            Self::Press(_) => "press",
            Self::Fingertip(_) => "fingertip",
        }
    }

    /// Checks the rules that concern several fields. The error is the field and the problem.
    pub(super) fn check(&self) -> Result<(), (&'static str, &'static str)> {
        match self {
            Self::Roll(roll) => roll.check(),
            Self::Glide(glide) => glide.check(),
            Self::Press(press) => press.check(),
            Self::Fingertip(_) => Ok(()),
        }
    }

    /// The model; `None` for a scene without contact.
    pub fn model(&self) -> Option<ModelConfig> {
        match self {
            Self::Roll(roll) => Some(ModelConfig::Roll(roll.model.clone())),
            Self::Press(press) => Some(ModelConfig::Press(press.model.clone())),
            Self::Glide(glide) => Some(ModelConfig::Glide(glide.model.clone())),
            Self::Fingertip(_) => None,
        }
    }

    /// The scene with another model. Estimator settings that default to the present model stay. `None` if the model is of
    /// another kind of scene.
    #[must_use]
    pub fn with_model(&self, model: &ModelConfig) -> Option<Self> {
        let mut scene = self.clone();
        match (&mut scene, model) {
            (Self::Roll(roll), ModelConfig::Roll(model)) => roll.model = model.clone(),
            (Self::Glide(glide), ModelConfig::Glide(model)) => glide.model = model.clone(),
            (Self::Press(press), ModelConfig::Press(model)) => {
                let (thickness, poisson) = (press.model.thickness(), press.model.poisson());
                press.estimator.keep(thickness, poisson);
                press.model = model.clone();
            }
            _ => return None,
        }
        Some(scene)
    }
}

/// How the truth of a scene is computed: the table `scene.model`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ModelConfig {
    /// Model of a roll.
    Roll(RollModelConfig),
    /// Model of a glide.
    Glide(GlideModelConfig),
    /// Model of a press.
    Press(PressModelConfig),
}

/// A kind of result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Output {
    /// The table of cells and quantities.
    Cells,
    /// One noiseless pass of the first cell.
    Trace,
    /// The estimated curvatures over a patch; of a press, the true and the estimated displacement along a radius.
    Map,
}

/// The unit of every length of a study. Curvatures are in its inverse.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LengthUnit {
    /// Metre.
    M,
    /// Centimetre.
    Cm,
    /// Millimetre.
    Mm,
    /// Micrometre.
    Um,
    /// Lengths are multiples of a length that the study does not state.
    #[default]
    Unit,
}

impl LengthUnit {
    /// All units.
    pub(crate) const ALL: [Self; 5] = [Self::M, Self::Cm, Self::Mm, Self::Um, Self::Unit];

    /// The unit as in configs and column names.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::M => "m",
            Self::Cm => "cm",
            Self::Mm => "mm",
            Self::Um => "um",
            Self::Unit => "unit",
        }
    }

    /// Factor from this unit to another: 1000 from metres to millimetres. `None` if only one of them is metric.
    pub fn to(self, other: Self) -> Option<f64> {
        let per_metre = |unit| match unit {
            Self::M => Some(1.0),
            Self::Cm => Some(1e2),
            Self::Mm => Some(1e3),
            Self::Um => Some(1e6),
            Self::Unit => None,
        };
        match (per_metre(self), per_metre(other)) {
            (Some(these), Some(others)) => Some(others / these),
            (None, None) => Some(1.0),
            _ => None,
        }
    }
}
