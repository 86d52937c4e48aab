//! The `[[plot]]` section: plots of a study's tables.

mod check;

use super::validate::NAME;
use palpate_statistics::Number;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use strum::IntoStaticStr;

use super::study::Output;
use std::collections::BTreeMap;

pub(super) use check::{check, check_alone};

/// A plot of a study's table. The plot's keys name a column of the table by the path of a swept field, or by the name
/// of a statistic in `cells.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlotConfig {
    /// Name of the plot's file. By default, it is made from the names of the columns.
    #[schemars(extend("pattern" = NAME, "maxLength" = 100))]
    pub name: Option<String>,
    /// Title of the plot; by default the title of the study.
    pub title: Option<String>,
    /// Kind of the plot. It determines which keys the plot may have. All kinds have the keys `name` and `title`; all
    /// kinds except `contacts` have `where`. The kind `profile` also has `component`, `panels`, `marks` and `points`.
    /// The kind `lines` has every key except `component`.
    #[serde(default, skip_serializing_if = "PlotKind::is_lines")]
    pub kind: PlotKind,
    /// Column whose values are plotted along x. Plots of the kind `lines` need this key.
    pub x: Option<String>,
    /// Statistic that is plotted along y. Plots of the kind `lines` need this key.
    pub y: Option<String>,
    /// Quantity to plot; by default every quantity.
    pub quantity: Option<String>,
    /// Column whose values separate the lines. There is one line for each value.
    pub series: Option<String>,
    /// Component of the displacement that a profile shows; by default the normal component.
    pub component: Option<Component>,
    /// Column whose values separate the panels. There is one panel for each value.
    pub panels: Option<String>,
    /// Filter that selects the plotted rows of the table. In a class map or a profile, it selects the plotted cells,
    /// that is, combinations of the swept values. Each entry consists of the name of a column in quotes, and the value
    /// or list of values that pass the filter.
    #[serde(default, rename = "where", skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(with = "BTreeMap<String, serde_json::Value>")]
    pub where_: BTreeMap<String, toml::Value>,
    /// Axes of the plot that have a logarithmic scale.
    #[serde(default)]
    pub scale: Scale,
    /// A second statistic, which is plotted for comparison.
    pub compare: Option<String>,
    /// Straight reference lines across the plot, each at a given value of one axis.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<Mark>,
    /// Points from other sources, for example published numbers. They are drawn as open markers for comparison.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<Points>,
}

impl PlotConfig {
    /// The entries of the filter `where`: the name of a column, and the texts of the values that pass the filter.
    pub fn filters(&self) -> impl Iterator<Item = (&str, Vec<String>)> {
        let text = |value: &toml::Value| match value {
            toml::Value::String(text) => text.clone(),
            toml::Value::Integer(integer) => integer.to_string(),
            toml::Value::Float(float) => Number(*float).to_string(),
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

/// Kind of a plot. It determines which result is plotted.
#[derive(
    Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema, IntoStaticStr,
)]
#[strum(serialize_all = "kebab-case")]
#[serde(rename_all = "kebab-case")]
pub enum PlotKind {
    /// Lines that plot one column of `cells.csv` over another.
    #[default]
    Lines,
    /// For each cell of the study, a map of the estimated shape classes beside a map of the true shape classes.
    ClassMap,
    /// For each cell of the study, the estimated shape classes, drawn on the fitted surface in three dimensions.
    ClassSurface,
    /// The contacts of the trial that the output `trace` records, as points in space.
    Contacts,
    /// The true and the estimated displacements over the distance from the contact, for the press in each cell of the
    /// study.
    Profile,
}

impl PlotKind {
    // The parameter is a reference because `skip_serializing_if` requires one.
    #[allow(clippy::trivially_copy_pass_by_ref)]
    fn is_lines(&self) -> bool {
        *self == Self::Lines
    }

    /// The output of a study that contains the data of this kind of plot, and the name of this output in configs.
    fn output(self) -> (Output, &'static str) {
        match self {
            Self::Lines => (Output::Cells, "cells"),
            Self::ClassMap | Self::ClassSurface | Self::Profile => (Output::Map, "map"),
            Self::Contacts => (Output::Trace, "trace"),
        }
    }

    /// Kind of scene that can have this plot; `None` if all kinds of scenes can have it.
    pub fn scene(self) -> Option<&'static str> {
        match self {
            Self::Lines => None,
            Self::ClassMap | Self::ClassSurface | Self::Contacts => Some("glide"),
            Self::Profile => Some("press"),
        }
    }

    /// List of the keys besides `kind` that this kind of plot may have.
    fn keys(self) -> &'static str {
        match self {
            Self::Lines => {
                "name, title, x, y, quantity, series, panels, where, scale, compare, marks, points"
            }
            Self::ClassMap | Self::ClassSurface => "name, title, where, scale",
            Self::Contacts => "name, title, scale",
            Self::Profile => "name, title, component, panels, where, scale, marks, points",
        }
    }
}

/// A component of a marker's displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Component {
    /// Normal displacement, positive inward.
    Normal,
    /// Displacement along the skin, positive away from the contact.
    Radial,
}

/// Axes of a plot that have a logarithmic scale.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Both axes of the plot are linear.
    #[default]
    Linear,
    /// Only the x axis is logarithmic.
    LogX,
    /// Only the y axis is logarithmic.
    LogY,
    /// Both axes are logarithmic.
    LogLog,
}

/// A straight reference line across a plot, at a given value of one axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mark {
    /// The axis on which the reference line's `value` is measured.
    pub axis: MarkAxis,
    /// Value at which the reference line is drawn, in the unit of the axis.
    pub value: f64,
    /// Text beside the reference line.
    pub label: String,
}

/// An axis of a plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MarkAxis {
    /// The horizontal axis.
    X,
    /// The vertical axis.
    Y,
}

/// Points from other sources, for example published numbers, that are added to a plot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Points {
    /// Name of the points in the plot's legend. Points with the same label have the same style.
    pub label: String,
    /// x values of the points, in the unit of the x axis.
    #[schemars(extend("minItems" = 1))]
    pub x: Vec<f64>,
    /// y values of the points, in the unit of the y axis. The number of x values and of y values must be equal.
    pub y: Vec<f64>,
    /// The line of the plot whose colour the points have. Each line belongs to one value of the column that the plot's
    /// key `series` names: state this value. In a plot of the kind `profile`, state the name of the line.
    pub series: Option<String>,
    /// The panel in which the points are drawn. Each panel belongs to one value of the column that the plot's key
    /// `panels` names: state this value. By default, the points are drawn in every panel.
    pub panel: Option<String>,
}
