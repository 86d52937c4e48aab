//! The top level of a study's config.

use super::fingertip::BareFingertipConfig;
use super::glide::GlideConfig;
use super::length_unit::LengthUnit;
use super::output::Output;
use super::plot::PlotConfig;
use super::press::PressConfig;
use super::roll::RollConfig;
use super::sweep::SweepConfig;
use super::validate::NAME;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
    #[serde(default = "ten_thousand")]
    #[schemars(extend("minimum" = 1))]
    pub trials: u64,
    /// Numbers of the published claims that are scored from this study's tables.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub claims: Vec<u32>,
    /// Results that the study writes.
    #[serde(default = "cells_only")]
    pub outputs: Vec<Output>,
    /// Version of the crate that wrote a resolved config; ignored when read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crate_version: Option<String>,
    /// The scene: the bodies that touch, and how that is modelled, sensed and estimated.
    pub scene: SceneConfig,
    /// Axes along which fields are varied; axes multiply, the first varies slowest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sweep: Vec<SweepConfig>,
    /// Plots of the study's table.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub plot: Vec<PlotConfig>,
}

fn ten_thousand() -> u64 {
    10_000
}

fn cells_only() -> Vec<Output> {
    vec![Output::Cells]
}

/// A scene, by the way in which its bodies touch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum SceneConfig {
    /// A probe rolls on an object.
    Roll(RollConfig),
    /// Fingers slide over a patch of an object.
    Glide(GlideConfig),
    /// A soft sphere with markers is pressed onto an object.
    Press(PressConfig),
    /// A sensor with markers is looked at, and touches nothing.
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

    /// Rules that join several fields; the error names the field and says what is wrong.
    pub(super) fn check(&self) -> Result<(), (&'static str, &'static str)> {
        match self {
            Self::Roll(roll) => roll.check(),
            Self::Glide(glide) => glide.check(),
            Self::Press(press) => press.check(),
            Self::Fingertip(_) => Ok(()),
        }
    }
}
