//! Checks rules for plots that a JSON Schema cannot express: which keys, tables and columns can be combined.

use super::{PlotConfig, PlotKind, Points, Scale};
use crate::Statistic;
use crate::config::error::Fault;
use crate::config::grid::Grid;
use crate::config::study::Output;
use crate::config::tree::{suggest, text};
use toml::Value;

/// Checks the plots of a study, after the schema has accepted them. The keys of each plot must be compatible with each
/// other. The study must write the table that the plot needs, and the named columns must exist.
pub(in crate::config) fn check(
    section: &Value,
    plots: &[PlotConfig],
    grid: &Grid,
    outputs: &[Output],
) -> Result<(), Fault> {
    each(section, plots, |keys, plot| {
        check_keys(keys, plot)?;
        check_output(keys, plot, grid, outputs)?;
        check_columns(plot, grid)?;
        check_points(plot, |points| check_place(points, plot, grid))
    })
}

/// Checks plots without their study, after the schema has accepted them. The plots must have different names and only
/// keys of their kind. Their points must have equal numbers of x and y values.
pub(in crate::config) fn check_alone(section: &Value, plots: &[PlotConfig]) -> Result<(), Fault> {
    each(section, plots, |keys, plot| {
        check_keys(keys, plot)?;
        check_points(plot, |_| Ok(()))
    })
}

/// Applies `rules` to the keys of every plot, and rejects a plot with the same name as an earlier plot.
fn each(
    section: &Value,
    plots: &[PlotConfig],
    rules: impl Fn(&[&str], &PlotConfig) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let written = section.as_array().into_iter().flatten();
    for (index, (written, plot)) in written.zip(plots).enumerate() {
        let under = |fault: Fault| fault.under(index).under("plot");
        let keys = written.as_table().into_iter().flat_map(toml::Table::keys);
        let keys: Vec<&str> = keys.map(String::as_str).collect();
        rules(&keys, plot).map_err(under)?;
        let is_taken = |earlier: &PlotConfig| plot.name.is_some() && earlier.name == plot.name;
        if plots[..index].iter().any(is_taken) {
            return Err(under(
                Fault::new("another plot has this name").under("name"),
            ));
        }
    }
    Ok(())
}

fn check_keys(keys: &[&str], plot: &PlotConfig) -> Result<(), Fault> {
    let is_lines = plot.kind == PlotKind::Lines;
    let missing = ["x", "y"].into_iter().find(|key| !keys.contains(key));
    if let Some(key) = missing.filter(|_| is_lines) {
        return Err(Fault::new("missing key").under(key));
    }
    let (name, known) = (<&str>::from(plot.kind), plot.kind.keys());
    let is_stray = |key: &&&str| **key != "kind" && !known.split(", ").any(|known| known == **key);
    if let Some(key) = keys.iter().find(is_stray) {
        let message = format!("unknown key for kind `{name}`; known: {known}, kind");
        return Err(Fault::of_key(key, message));
    }
    match !is_lines && plot.scale != Scale::Linear {
        true => Err(Fault::new("only lines can have a scale other than linear").under("scale")),
        false => Ok(()),
    }
}

fn check_output(
    keys: &[&str],
    plot: &PlotConfig,
    grid: &Grid,
    outputs: &[Output],
) -> Result<(), Fault> {
    let (output, name) = plot.kind.output();
    if !keys.contains(&"kind") {
        return Ok(());
    }
    let message = match (plot.kind.scene(), scene_kind(grid)) {
        _ if !outputs.contains(&output) => {
            format!("needs the output \"{name}\", which `outputs` does not list")
        }
        (Some(wanted), Some(found)) if wanted != found => {
            format!("needs a scene of kind {wanted}, but this scene is of kind {found}")
        }
        _ => return Ok(()),
    };
    Err(Fault::new(message).under("kind"))
}

fn scene_kind(grid: &Grid) -> Option<&str> {
    grid.base.get("scene")?.get("kind")?.as_str()
}

fn statistics(grid: &Grid) -> impl Iterator<Item = &str> + Clone {
    let bound = scene_kind(grid) == Some("press");
    let all = Statistic::ALL.into_iter();
    let all = all.chain(bound.then_some(Statistic::StdBound));
    all.map(|statistic| -> &str { statistic.name() })
}

fn check_columns(plot: &PlotConfig, grid: &Grid) -> Result<(), Fault> {
    let is_lines = plot.kind == PlotKind::Lines;
    let swept = || grid.targets().map(|target| target.path.as_str());
    let of_lines = || statistics(grid).filter(move |_| is_lines);
    for (key, name) in [("y", &plot.y), ("compare", &plot.compare)] {
        check_column(name.as_ref(), of_lines()).map_err(|fault| fault.under(key))?;
    }
    let quantity = || is_lines.then_some("quantity");
    for (key, name, extra) in [
        ("x", &plot.x, None),
        ("series", &plot.series, quantity()),
        ("panels", &plot.panels, quantity()),
    ] {
        let columns = swept().chain(of_lines()).chain(extra);
        check_column(name.as_ref(), columns).map_err(|fault| fault.under(key))?;
    }
    for (column, value) in &plot.where_ {
        let under = |fault: Fault| fault.under(column).under("where");
        check_column(Some(column), swept().chain(of_lines())).map_err(|fault| Fault {
            is_key: true,
            ..under(fault)
        })?;
        match value {
            Value::Array(items) => items.iter().enumerate().try_for_each(|(index, item)| {
                check_value(&text(item), grid, column).map_err(|fault| under(fault.at(index)))
            })?,
            value => check_value(&text(value), grid, column).map_err(under)?,
        }
    }
    Ok(())
}

/// Rejects the value `wanted` if the swept field at `path` does not have this value in any cell.
fn check_value(wanted: &str, grid: &Grid, path: &str) -> Result<(), Fault> {
    const MOST_SHOWN: usize = 100;
    let Some((axis, place)) = grid.axis(path) else {
        return Ok(());
    };
    let text = |index: usize| axis.row(index)[place].text().into_owned();
    if (0..axis.len()).any(|index| axis.row(index)[place].text() == wanted) {
        return Ok(());
    }
    let shown: Vec<String> = (0..axis.len().min(MOST_SHOWN)).map(text).collect();
    let more = match axis.len() - shown.len() {
        0 => String::new(),
        more => format!(" and {more} more, the last {}", text(axis.len() - 1)),
    };
    let shown = shown.join(", ");
    Err(Fault::new(format!(
        "no cell has {wanted}; the sweep has {shown}{more}"
    )))
}

fn check_points(
    plot: &PlotConfig,
    rules: impl Fn(&Points) -> Result<(), Fault>,
) -> Result<(), Fault> {
    for (index, points) in plot.points.iter().enumerate() {
        let [x, y] = [points.x.len(), points.y.len()];
        let checked = match x == y {
            true => rules(points),
            false => Err(Fault::new(format!("has {y} values, and `x` has {x}")).under("y")),
        };
        checked.map_err(|fault| fault.under(index).under("points"))?;
    }
    Ok(())
}

/// Checks that the plot has the series and the panel that `points` states. In a profile, the series is the name of a
/// line. It is not checked, because only the results of a run contain the names of lines.
fn check_place(points: &Points, plot: &PlotConfig, grid: &Grid) -> Result<(), Fault> {
    for (key, value, column, path) in [
        ("series", &points.series, "series", &plot.series),
        ("panel", &points.panel, "panels", &plot.panels),
    ] {
        let Some(value) = value else { continue };
        let checked = match path {
            Some(path) => check_value(value, grid, path),
            None if plot.kind == PlotKind::Profile && key == "series" => Ok(()),
            None => Err(Fault::new(format!("the plot has no `{column}`"))),
        };
        checked.map_err(|fault| fault.under(key))?;
    }
    Ok(())
}

fn check_column<'a>(
    name: Option<&String>,
    columns: impl Iterator<Item = &'a str> + Clone,
) -> Result<(), Fault> {
    match name {
        Some(name) if !columns.clone().any(|column| column == name) => Err(Fault::new(format!(
            "no column `{name}`; {}",
            suggest(name, columns)
        ))),
        _ => Ok(()),
    }
}
