//! Rules of plots that no schema states: which keys, tables and columns go together.

use super::{PlotKind, STATISTICS, STD_BOUND};
use crate::config::error::Fault;
use crate::config::grid::Grid;
use crate::config::study::Output;
use crate::config::tree::{Entry, Node, Value, suggest};
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::StrDeserializer;

/// Checks that the plots of a `plot` section, which has been validated against the schema, stand for themselves, are
/// drawn from tables that are written, and name columns that exist.
pub(in crate::config) fn check(
    section: &Node,
    grid: &Grid,
    outputs: &[Output],
) -> Result<(), Fault> {
    each(section, |plot, kind| {
        keys(plot, kind)?;
        written(plot, kind, grid, outputs)?;
        columns(plot, kind, grid)?;
        points(plot, |set| places(set, plot, kind, grid))
    })
}

/// Checks as much of the plots of a `plot` section, which has been validated against the schema, as they say alone: that
/// they have the keys of their kind and names of their own, and that their points are pairs.
pub(in crate::config) fn check_alone(section: &Node) -> Result<(), Fault> {
    each(section, |plot, kind| {
        keys(plot, kind)?;
        points(plot, |_| Ok(()))
    })
}

/// Holds every plot against `rules`, and its name against those before it.
fn each(section: &Node, rules: impl Fn(&Node, PlotKind) -> Result<(), Fault>) -> Result<(), Fault> {
    let mut names = Vec::new();
    for (index, plot) in section.items().iter().enumerate() {
        let under = |fault: Fault| fault.under(index).under("plot");
        rules(plot, kind_of(plot)).map_err(under)?;
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
    let kind = plot.get("kind").and_then(Node::as_text);
    let named = |name: &str| {
        let name: StrDeserializer<'_, serde::de::value::Error> = name.into_deserializer();
        PlotKind::deserialize(name).ok()
    };
    kind.and_then(named).unwrap_or_default()
}

fn keys(plot: &Node, kind: PlotKind) -> Result<(), Fault> {
    if kind == PlotKind::Lines
        && let Some(key) = ["x", "y"].into_iter().find(|key| plot.get(key).is_none())
    {
        return Err(Fault::at(&plot.span, "missing key").under(key));
    }
    let (name, known) = kind.keys();
    let known = || known.iter().copied().chain(["kind"]);
    let stray = |entry: &&Entry| known().all(|key| key != entry.key);
    if let Some(entry) = plot.entries().iter().find(stray) {
        let message = format!(
            "unknown key for kind `{name}`; known: {}",
            known().collect::<Vec<_>>().join(", ")
        );
        return Err(Fault::at(&entry.key_span, message).under(&entry.key));
    }
    match plot
        .get("scale")
        .filter(|scale| kind != PlotKind::Lines && scale.as_text() != Some("linear"))
    {
        Some(scale) => {
            Err(Fault::at(&scale.span, "only lines have another scale than linear").under("scale"))
        }
        None => Ok(()),
    }
}

fn written(plot: &Node, kind: PlotKind, grid: &Grid, outputs: &[Output]) -> Result<(), Fault> {
    let (output, name) = kind.output();
    let Some(node) = plot.get("kind") else {
        return Ok(());
    };
    if !outputs.contains(&output) {
        let message =
            format!("is drawn from the output \"{name}\", which `outputs` does not ask for");
        return Err(Fault::at(&node.span, message).under("kind"));
    }
    match (kind.scene(), scene_kind(grid)) {
        (Some(wanted), Some(found)) if wanted != found => {
            let message = format!("is drawn from a {wanted}, and this scene is a {found}");
            Err(Fault::at(&node.span, message).under("kind"))
        }
        _ => Ok(()),
    }
}

fn scene_kind(grid: &Grid) -> Option<&str> {
    grid.base.get("scene")?.get("kind")?.as_text()
}

/// The statistics that a table of this scene's cells has.
fn statistics(grid: &Grid) -> impl Iterator<Item = &str> + Clone {
    let bound = scene_kind(grid) == Some("press");
    STATISTICS.into_iter().chain(bound.then_some(STD_BOUND))
}

fn columns(plot: &Node, kind: PlotKind, grid: &Grid) -> Result<(), Fault> {
    let swept = || grid.targets().map(|target| target.path.as_str());
    let of_lines = || statistics(grid).filter(|_| kind == PlotKind::Lines);
    for key in ["y", "compare"] {
        if let Some(node) = plot.get(key) {
            known(node, of_lines()).map_err(|fault| fault.under(key))?;
        }
    }
    let quantity = || (kind == PlotKind::Lines).then_some("quantity");
    for (key, extra) in [("x", None), ("series", quantity()), ("panels", quantity())] {
        if let Some(node) = plot.get(key) {
            known(node, swept().chain(of_lines()).chain(extra))
                .map_err(|fault| fault.under(key))?;
        }
    }
    for entry in plot.get("where").map_or(&[][..], Node::entries) {
        let under = |fault: Fault| fault.under(&entry.key).under("where");
        let column = Node {
            value: Value::Text(entry.key.clone()),
            span: entry.key_span.clone(),
        };
        known(&column, swept().chain(of_lines())).map_err(under)?;
        let values = std::iter::once(&entry.node)
            .filter(|node| node.items().is_empty())
            .chain(entry.node.items());
        for value in values {
            value_of(value, grid, &entry.key).map_err(under)?;
        }
    }
    Ok(())
}

/// Checks that a value is among those that a column of the sweep takes.
fn value_of(value: &Node, grid: &Grid, path: &str) -> Result<(), Fault> {
    const MOST_SHOWN: usize = 100;
    let Some((axis, place)) = grid.axis(path) else {
        return Ok(());
    };
    let text = |index: usize| axis.row(index)[place].text().into_owned();
    let wanted = value.text();
    if (0..axis.len()).any(|index| axis.row(index)[place].text() == wanted) {
        return Ok(());
    }
    let shown: Vec<String> = (0..axis.len().min(MOST_SHOWN)).map(text).collect();
    let more = match axis.len() - shown.len() {
        0 => String::new(),
        more => format!(" and {more} more, the last {}", text(axis.len() - 1)),
    };
    let message = format!(
        "no cell has {wanted}; the sweep has {}{more}",
        shown.join(", ")
    );
    Err(Fault::at(&value.span, message))
}

/// Checks that points have as many y as x, and follow more `rules`.
fn points(plot: &Node, rules: impl Fn(&Node) -> Result<(), Fault>) -> Result<(), Fault> {
    let sets = plot.get("points").map_or(&[][..], Node::items);
    for (index, set) in sets.iter().enumerate() {
        let under = |fault: Fault| fault.under(index).under("points");
        let length = |key: &str| set.get(key).map_or(0, |node| node.items().len());
        if let Some(y) = set.get("y").filter(|_| length("x") != length("y")) {
            let message = format!("has {} values, and `x` has {}", length("y"), length("x"));
            return Err(under(Fault::at(&y.span, message).under("y")));
        }
        rules(set).map_err(under)?;
    }
    Ok(())
}

/// Checks that points belong to a series and a panel that the plot has. The lines of a profile have labels that only
/// its table tells.
fn places(set: &Node, plot: &Node, kind: PlotKind, grid: &Grid) -> Result<(), Fault> {
    for (key, column) in [("series", "series"), ("panel", "panels")] {
        let Some(value) = set.get(key) else { continue };
        let under = |fault: Fault| fault.under(key);
        match plot.get(column).and_then(Node::as_text) {
            Some(path) => value_of(value, grid, path).map_err(under)?,
            None if kind == PlotKind::Profile && key == "series" => {}
            None => {
                let message = format!("the plot has no `{column}`");
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
