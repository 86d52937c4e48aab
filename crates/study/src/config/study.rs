//! The top level of a study's config.

use super::fingertip::BareFingertipConfig;
use super::glide::GlideConfig;
use super::plot::PlotConfig;
use super::press::PressConfig;
use super::roll::RollConfig;
use super::schema;
use super::sweep::SweepConfig;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A study: one scene, the axes along which it is varied, and the plots drawn from its table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyConfig {
    /// Name of the study and of its folder of results: lower-case words joined by hyphens.
    #[schemars(extend("pattern" = schema::NAME, "maxLength" = 100))]
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
    /// The unit as it stands in configs and column names.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::M => "m",
            Self::Cm => "cm",
            Self::Mm => "mm",
            Self::Um => "um",
            Self::Unit => "unit",
        }
    }

    /// Number of these in another unit: 1000 for metres in millimetres. `None` where only one of them is of the metric
    /// system.
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

/// A config as TOML, defaults filled in, which parses back to the same config.
///
/// Where a sweep varies a `kind`, keys of that table that equal their default are left out, because another kind may
/// not know them.
///
/// ```
/// use palpate_study::config::{parse, to_toml};
///
/// let text = r#"
///     name = "roll-on-a-ball"
///     scene.kind = "roll"
///     scene.probe = { kind = "sphere", radius = 1.0 }
///     scene.object = { kind = "sphere", radius = 4.0 }
///     scene.motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// "#;
/// let study = parse("study.toml", text)?;
/// let resolved = to_toml(&study.config);
/// assert!(resolved.contains("seed = 0"));
/// assert_eq!(parse("run.toml", &resolved)?.config, study.config);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_toml(config: &StudyConfig) -> String {
    let text =
        toml::to_string(config).expect("strings, numbers, arrays and tables all have a TOML form");
    let paths = config.sweep.iter().flat_map(SweepConfig::targets);
    let swept: Vec<&str> = paths
        .filter_map(|path| path.strip_suffix(".kind"))
        .collect();
    match text.parse::<toml::Table>() {
        Ok(mut table) if !swept.is_empty() => {
            let root = schema();
            swept
                .iter()
                .for_each(|path| schema::drop_defaults(&root, &mut table, path));
            table.to_string()
        }
        _ => text,
    }
}
