//! The top level of a study's config, and the types that all scenes share.

use super::glide::{GlideConfig, GlideModelConfig};
use super::marker_sensor::BareFingertipConfig;
use super::plot::PlotConfig;
use super::press::{PressConfig, PressModelConfig};
use super::roll::{RollConfig, RollModelConfig};
use super::schema::count;
use super::sweep::SweepConfig;
use super::validate::NAME;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use strum::IntoStaticStr;

/// A study: one scene, the axes along which fields of the scene are varied, and the plots of the study's tables.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyConfig {
    /// Name of the study and of its output directory: lower-case words or numbers, joined by hyphens.
    #[schemars(extend("pattern" = NAME, "maxLength" = 100))]
    pub name: String,
    /// Title of the study: the question that it answers.
    #[serde(default)]
    pub title: String,
    /// Source of the study, e.g. a section and a figure of a paper.
    #[serde(default)]
    pub source: String,
    /// The unit of every length in the config and in its results.
    #[serde(default)]
    pub length_unit: LengthUnit,
    /// Seed of all random numbers of the study.
    #[serde(default)]
    pub seed: u64,
    /// Number of trials per cell, that is, per combination of swept values. A scene without noise runs only one trial.
    #[serde(default = "count::<10_000>")]
    #[schemars(extend("minimum" = 1))]
    pub trials: u64,
    /// Rule that decides how many trials each cell runs. It replaces a fixed number of trials.
    pub stop: Option<StopConfig>,
    /// Numbers of the claims of the published papers that are tested with this study's tables.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub claims: Vec<u32>,
    /// Kinds of results that the study writes.
    #[serde(default = "cells_only")]
    pub outputs: Vec<Output>,
    /// Version of palpate that wrote the config. It is missing in a config that a person wrote.
    pub crate_version: Option<String>,
    /// Names of the columns in files of recorded readings. `palpate estimate --like` with this study uses them. The key
    /// is palpate's name of a column, and the value is its name in the file: `x = "Finger X [m]"`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub columns: BTreeMap<String, String>,
    /// The scene: the bodies in contact, the motion, the model, the sensor, the noise and the estimator.
    pub scene: SceneConfig,
    /// Sweep axes, which vary fields of the config. Each combination of their values is a cell of the study. The first
    /// axis varies slowest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) sweep: Vec<SweepConfig>,
    /// Plots of the study's tables. Without this section, one default plot is drawn: the relative rms error of the
    /// object's curvature over the first swept field. It has one line for each value of the second swept field, and one
    /// panel for each value of the third.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plot: Vec<PlotConfig>,
}

/// Stopping rule. The trials of a cell (one combination of the swept values) end when the relative standard error of a
/// statistic is small enough.
///
/// The trials run in blocks of 1,024, in the order of their numbers. The rule is tested after 1, 2, 4, 8 … blocks. The
/// standard error is computed from the scatter between trials. The observations within one trial, for example at all
/// points of a patch, count as a single observation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StopConfig {
    /// The trials of a cell end when the relative standard error of the statistic is at most this value.
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = 1.0))]
    pub relative_standard_error: f64,
    /// Quantity whose statistic is tested, by its name in `cells.csv`. The default is the first quantity of the scene.
    pub quantity: Option<String>,
    /// The statistic whose relative standard error the rule tests.
    #[serde(default)]
    pub statistic: StopStatistic,
    /// Smallest number of trials per cell.
    #[serde(default = "count::<1024>")]
    #[schemars(extend("minimum" = 1))]
    pub min_trials: u64,
    /// Largest number of trials per cell.
    #[schemars(extend("minimum" = 1))]
    pub max_trials: u64,
}

/// Statistic that the stopping rule tests.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StopStatistic {
    /// Mean of the estimates of the quantity.
    Mean,
    /// Root of the mean squared error of the estimates of the quantity.
    #[default]
    RmsError,
    /// Mean absolute error of the estimates of the quantity.
    MeanAbsError,
}

fn cells_only() -> Vec<Output> {
    vec![Output::Cells]
}

/// A scene. Its kind states how the sensor touches the object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
#[expect(clippy::large_enum_variant, reason = "a study has one scene")]
pub enum SceneConfig {
    /// A probe rolls on an object.
    Roll(RollConfig),
    /// Fingers slide over a patch of an object.
    Glide(GlideConfig),
    /// A soft sphere with markers is pressed onto an object.
    Press(PressConfig),
    /// A sensor with markers, without an object. The study computes the size of a marker in the image (`marker_area`).
    /// It also computes the strain that is caused by folding the sensor's skin from flat pieces
    /// (`greatest_fold_strain`, `rms_fold_strain`). The scene has no random numbers.
    Fingertip(BareFingertipConfig),
}

impl SceneConfig {
    /// Name of the scene's kind, as configs state it.
    pub fn kind(&self) -> &'static str {
        self.into()
    }

    /// Checks the rules of the scene that involve several fields. The error consists of the path of the field and a
    /// description of the problem.
    pub(super) fn check(&self) -> Result<(), (&'static str, &'static str)> {
        match self {
            Self::Roll(roll) => roll.check(),
            Self::Glide(glide) => glide.check(),
            Self::Press(press) => press.check(),
            Self::Fingertip(_) => Ok(()),
        }
    }

    /// The contact model of the scene; `None` for a scene without contact.
    pub fn model(&self) -> Option<ModelConfig> {
        match self {
            Self::Roll(roll) => Some(ModelConfig::Roll(roll.model.clone())),
            Self::Press(press) => Some(ModelConfig::Press(press.model.clone())),
            Self::Glide(glide) => Some(ModelConfig::Glide(glide.model.clone())),
            Self::Fingertip(_) => None,
        }
    }

    /// The scene with another model; `None` if `model` belongs to another kind of scene. The estimator does not change:
    /// if the default of one of its settings is a value of the previous model (such as Poisson's ratio), the setting
    /// keeps this value.
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

/// The model that computes the true values of a scene: the table `scene.model`.
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

/// A kind of result that a study writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Output {
    /// The tables with the statistics of all cells and quantities.
    Cells,
    /// A trace: the contacts or displacements of one trial of the first cell, without noise.
    Trace,
    /// For a glide, a map of the estimated curvatures over the patch. For a press, the true and the estimated
    /// displacements over the distance from the contact.
    Map,
}

/// The unit of every length in a study. Curvatures have the inverse unit.
#[derive(
    Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, IntoStaticStr,
)]
#[strum(serialize_all = "kebab-case")]
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
    /// An unspecified unit of length.
    #[default]
    Unit,
}

impl LengthUnit {
    pub(crate) const ALL: [Self; 5] = [Self::M, Self::Cm, Self::Mm, Self::Um, Self::Unit];

    /// Name of the unit, as configs and column names state it.
    pub fn as_str(self) -> &'static str {
        self.into()
    }

    /// Factor from this unit to `other`, for example 1000 from metres to millimetres. `None` if one of the units is
    /// metric and the other is not.
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
