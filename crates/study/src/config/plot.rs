//! The `[[plot]]` section: plots of a study's tables.

mod check;

use super::validate::NAME;
use crate::number;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::study::Output;
use std::collections::BTreeMap;

pub(super) use check::{check, check_alone};

/// A plot. Columns are named by the path of a swept field or by a statistic of the table of cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlotConfig {
    /// Name of the plot's file, by default made from its columns.
    #[schemars(extend("pattern" = NAME, "maxLength" = 100))]
    pub name: Option<String>,
    /// Title, by default that of the study.
    pub title: Option<String>,
    /// Kind of the plot. Every kind has a name, a title and, but for contacts, `where`; a profile has a component,
    /// panels, marks and points too, and lines have all but a component.
    #[serde(default, skip_serializing_if = "PlotKind::is_lines")]
    pub kind: PlotKind,
    /// Column along x; lines need it.
    pub x: Option<String>,
    /// Statistic along y; lines need it.
    pub y: Option<String>,
    /// The quantity that is drawn, by default every one.
    pub quantity: Option<String>,
    /// Column whose values make one line each.
    pub series: Option<String>,
    /// Displacement that a profile shows, by default the normal one.
    pub component: Option<Component>,
    /// Column whose values make one panel each.
    pub panels: Option<String>,
    /// Only rows (of a class map or profile: cells) in which a column (in quotes) has this value, or one of these.
    #[serde(default, rename = "where", skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(with = "BTreeMap<String, serde_json::Value>")]
    pub where_: BTreeMap<String, toml::Value>,
    /// Which axes are logarithmic.
    #[serde(default)]
    pub scale: Scale,
    /// A second statistic, drawn for comparison.
    pub compare: Option<String>,
    /// Lines across the plot at given values.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<Mark>,
    /// Numbers from elsewhere, drawn as open markers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<Points>,
}

impl PlotConfig {
    /// Columns of `where`, each with the texts that a row may have there.
    pub fn filters(&self) -> impl Iterator<Item = (&str, Vec<String>)> {
        let text = |value: &toml::Value| match value {
            toml::Value::String(text) => text.clone(),
            toml::Value::Integer(integer) => integer.to_string(),
            toml::Value::Float(float) => number::exact(*float),
            other => other.to_string(),
        };
        self.where_.iter().map(move |(path, value)| {
            let values = value
                .as_array()
                .map_or(std::slice::from_ref(value), Vec::as_slice);
            (path.as_str(), values.iter().map(text).collect())
        })
    }
}

/// Kind of a plot: the result that it draws.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PlotKind {
    /// Columns of the table of cells against each other.
    #[default]
    Lines,
    /// The shape classes of every cell's map, beside the true ones.
    ClassMap,
    /// The shape classes of every cell's map on its fitted surface, in space.
    ClassSurface,
    /// The contacts of the traced pass, in space.
    Contacts,
    /// The displacement under every cell's press along a radius, true and estimated.
    Profile,
}

impl PlotKind {
    // `skip_serializing_if` takes a reference.
    #[allow(clippy::trivially_copy_pass_by_ref)]
    fn is_lines(&self) -> bool {
        *self == Self::Lines
    }

    /// The output whose table is drawn, and its name in configs.
    fn output(self) -> (Output, &'static str) {
        match self {
            Self::Lines => (Output::Cells, "cells"),
            Self::ClassMap | Self::ClassSurface | Self::Profile => (Output::Map, "map"),
            Self::Contacts => (Output::Trace, "trace"),
        }
    }

    /// Kind of the scenes whose tables it is drawn from; `None`: all.
    pub fn scene(self) -> Option<&'static str> {
        match self {
            Self::Lines => None,
            Self::ClassMap | Self::ClassSurface | Self::Contacts => Some("glide"),
            Self::Profile => Some("press"),
        }
    }

    /// Its name in configs.
    pub fn name(self) -> &'static str {
        self.keys().0
    }

    /// Its name in configs, and the keys besides `kind` that a plot of this kind may have.
    fn keys(self) -> (&'static str, &'static str) {
        match self {
            Self::Lines => (
                "lines",
                "name, title, x, y, quantity, series, panels, where, scale, compare, marks, points",
            ),
            Self::ClassMap => ("class-map", "name, title, where, scale"),
            Self::ClassSurface => ("class-surface", "name, title, where, scale"),
            Self::Contacts => ("contacts", "name, title, scale"),
            Self::Profile => (
                "profile",
                "name, title, component, panels, where, scale, marks, points",
            ),
        }
    }
}

/// A component of a displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Component {
    /// Normal displacement, positive inward.
    Normal,
    /// Displacement along the skin, positive away from the contact.
    Radial,
}

/// Which axes of a plot are logarithmic.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Neither.
    #[default]
    Linear,
    /// Only x.
    LogX,
    /// Only y.
    LogY,
    /// Both.
    LogLog,
}

impl Scale {
    /// Whether x, and whether y is logarithmic.
    pub fn logs(self) -> [bool; 2] {
        [
            matches!(self, Self::LogX | Self::LogLog),
            matches!(self, Self::LogY | Self::LogLog),
        ]
    }
}

/// A line across a plot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mark {
    /// The axis on which the value lies.
    pub axis: MarkAxis,
    /// The value, in the unit of the axis.
    pub value: f64,
    /// Text beside the line.
    pub label: String,
}

/// An axis of a plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MarkAxis {
    /// Across.
    X,
    /// Up.
    Y,
}

/// Numbers from elsewhere, published ones say, in a plot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Points {
    /// Name in the legend; points of one label look alike.
    pub label: String,
    /// Places along x, in the unit of the axis.
    #[schemars(extend("minItems" = 1))]
    pub x: Vec<f64>,
    /// Places along y, in the unit of the axis; as many as `x`.
    pub y: Vec<f64>,
    /// The series (of a profile: the line) whose colour they take.
    pub series: Option<String>,
    /// The panel they are drawn in, by default every one.
    pub panel: Option<String>,
}
