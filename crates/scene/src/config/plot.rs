//! The `[[plot]]` section: what is drawn from a study's tables.

use super::error::Fault;
use super::grid::Grid;
use super::study::Output;
use super::tree::{Entry, Node, suggest};
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

/// A plot. Columns are named by the path of a swept field or by a statistic of the table of cells.
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
    /// What is drawn; only lines have axes, a quantity, series and what follows them but `where`.
    #[serde(default, skip_serializing_if = "PlotKind::is_lines")]
    pub kind: PlotKind,
    /// Column along x; lines need it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x: Option<String>,
    /// Statistic along y; lines need it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y: Option<String>,
    /// The quantity that is drawn, by default every one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quantity: Option<String>,
    /// Column whose values make one line each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub series: Option<String>,
    /// Column whose values make one panel each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub panels: Option<String>,
    /// Only rows (of a class map: cells) in which a column (in quotes) has this value, or one of these.
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

/// What a plot draws.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PlotKind {
    /// Columns of the table of cells against each other.
    #[default]
    Lines,
    /// The shape classes of every cell's map, beside the true ones.
    ClassMap,
    /// The contacts of the traced pass, in space.
    Contacts,
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
            Self::ClassMap => (Output::Map, "map"),
            Self::Contacts => (Output::Trace, "trace"),
        }
    }

    /// The keys besides `kind` that a plot of this kind may have; `None`: all.
    fn keys(self) -> Option<&'static [&'static str]> {
        match self {
            Self::Lines => None,
            Self::ClassMap => Some(&["name", "title", "where", "scale"]),
            Self::Contacts => Some(&["name", "title", "scale"]),
        }
    }
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

/// Checks that the plots of a `plot` section, which has been validated against the schema, have the keys of their kind,
/// are drawn from tables that are written, and name columns that exist.
pub(super) fn check(section: &Node, grid: &Grid, outputs: &[Output]) -> Result<(), Fault> {
    let mut names = Vec::new();
    for (index, plot) in section.items().iter().enumerate() {
        let under = |fault: Fault| fault.under(index).under("plot");
        let kind = kind_of(plot);
        keys(plot, kind).map_err(under)?;
        written(plot, kind, outputs).map_err(under)?;
        columns(plot, kind, grid).map_err(under)?;
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

fn kind_of(plot: &Node) -> PlotKind {
    match plot.get("kind").and_then(Node::as_text) {
        Some("class-map") => PlotKind::ClassMap,
        Some("contacts") => PlotKind::Contacts,
        _ => PlotKind::Lines,
    }
}

fn keys(plot: &Node, kind: PlotKind) -> Result<(), Fault> {
    let Some(known) = kind.keys() else {
        let missing = ["x", "y"].into_iter().find(|key| plot.get(key).is_none());
        return missing.map_or(Ok(()), |key| {
            Err(Fault::at(&plot.span, "missing key").under(key))
        });
    };
    let known = || known.iter().copied().chain(["kind"]);
    let stray = |entry: &&Entry| known().all(|key| key != entry.key);
    if let Some(entry) = plot.entries().iter().find(stray) {
        let name = plot.get("kind").and_then(Node::as_text).unwrap_or_default();
        let message = format!(
            "unknown key for kind `{name}`; known: {}",
            known().collect::<Vec<_>>().join(", ")
        );
        return Err(Fault::at(&entry.key_span, message).under(&entry.key));
    }
    match plot
        .get("scale")
        .filter(|scale| scale.as_text() != Some("linear"))
    {
        Some(scale) => {
            Err(Fault::at(&scale.span, "only lines have another scale than linear").under("scale"))
        }
        None => Ok(()),
    }
}

fn written(plot: &Node, kind: PlotKind, outputs: &[Output]) -> Result<(), Fault> {
    let (output, name) = kind.output();
    match plot.get("kind") {
        Some(node) if !outputs.contains(&output) => {
            let message =
                format!("is drawn from the output \"{name}\", which `outputs` does not ask for");
            Err(Fault::at(&node.span, message).under("kind"))
        }
        _ => Ok(()),
    }
}

fn columns(plot: &Node, kind: PlotKind, grid: &Grid) -> Result<(), Fault> {
    let swept = || grid.targets().map(|target| target.path.as_str());
    let statistics = match kind {
        PlotKind::Lines => &STATISTICS[..],
        PlotKind::ClassMap | PlotKind::Contacts => &[],
    };
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
        known(&column, swept().chain(statistics.iter().copied())).map_err(under)?;
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
