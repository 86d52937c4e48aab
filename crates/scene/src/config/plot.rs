//! The `[[plot]]` section: which columns of a study's table are drawn against each other.

use super::error::Fault;
use super::grid::Grid;
use super::tree::{Node, suggest};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The columns of a table of cells that hold numbers of a quantity, in their order.
pub const STATISTICS: [&str; 15] = [
    "truth",
    "trials",
    "failures",
    "mean",
    "std",
    "bias",
    "rms_error",
    "mean_abs_error",
    "relative_rms_error",
    "relative_mean_abs_error",
    "q05",
    "q50",
    "q95",
    "mean_reported_std",
    "coverage95",
];

/// A plot. Columns are named by the path of a swept field or by a statistic of the table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlotConfig {
    /// Name of the plot's file, by default made from its columns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("pattern" = super::schema::NAME, "maxLength" = 100))]
    pub name: Option<String>,
    /// Title, by default that of the study.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// Column along x.
    pub x: String,
    /// Statistic along y.
    pub y: String,
    /// The quantity that is drawn, by default every one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quantity: Option<String>,
    /// Column whose values make one line each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub series: Option<String>,
    /// Column whose values make one panel each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub panels: Option<String>,
    /// Only rows in which a column (in quotes) has this value, or one of these.
    #[serde(default, rename = "where", skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(with = "BTreeMap<String, serde_json::Value>")]
    pub where_: BTreeMap<String, toml::Value>,
    /// Which axes are logarithmic.
    #[serde(default)]
    pub scale: Scale,
    /// A second statistic, drawn for comparison.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compare: Option<String>,
    /// Lines across the plot at given values.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<Mark>,
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

/// A line across a plot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mark {
    /// The axis on which the value lies.
    pub axis: MarkAxis,
    /// The value, in the unit of the axis.
    pub value: f64,
    /// What the line says.
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

/// Checks that the plots of a `plot` section, which has been validated against the schema, name columns that exist.
pub(super) fn check(section: &Node, grid: &Grid) -> Result<(), Fault> {
    let mut names = Vec::new();
    for (index, plot) in section.items().iter().enumerate() {
        let under = |fault: Fault| fault.under(index).under("plot");
        columns(plot, grid).map_err(under)?;
        if let Some(name) = plot.get("name") {
            if names.contains(&&name.value) {
                return Err(under(
                    Fault::at(&name.span, "another plot has this name").under("name"),
                ));
            }
            names.push(&name.value);
        }
    }
    Ok(())
}

fn columns(plot: &Node, grid: &Grid) -> Result<(), Fault> {
    let swept = || grid.targets().map(|target| target.path.as_str());
    for key in ["y", "compare"] {
        if let Some(node) = plot.get(key) {
            known(node, STATISTICS.into_iter()).map_err(|fault| fault.under(key))?;
        }
    }
    for (key, extra) in [
        ("x", None),
        ("series", Some("quantity")),
        ("panels", Some("quantity")),
    ] {
        if let Some(node) = plot.get(key) {
            known(node, swept().chain(STATISTICS).chain(extra))
                .map_err(|fault| fault.under(key))?;
        }
    }
    for entry in plot.get("where").map_or(&[][..], Node::entries) {
        let under = |fault: Fault| fault.under(&entry.key).under("where");
        let column = Node {
            value: super::tree::Value::Text(entry.key.clone()),
            span: entry.key_span.clone(),
        };
        known(&column, swept().chain(STATISTICS)).map_err(under)?;
        let texts = grid.texts(&entry.key);
        let values = std::iter::once(&entry.node)
            .filter(|node| node.items().is_empty())
            .chain(entry.node.items());
        for value in values {
            if let Some(texts) = texts
                .as_ref()
                .filter(|texts| !texts.contains(&value.text().as_str()))
            {
                let message = format!(
                    "no cell has {}; the sweep has {}",
                    value.text(),
                    texts.join(", ")
                );
                return Err(under(Fault::at(&value.span, message)));
            }
        }
    }
    Ok(())
}

fn known<'a>(node: &Node, columns: impl Iterator<Item = &'a str> + Clone) -> Result<(), Fault> {
    let name = node.as_text().unwrap_or_default();
    match columns.clone().any(|column| column == name) {
        true => Ok(()),
        false => Err(Fault::at(
            &node.span,
            format!("no column `{name}`; {}", suggest(name, columns)),
        )),
    }
}
