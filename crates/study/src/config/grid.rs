//! The cells of a study: all combinations of its axes' rows. The first axis varies slowest.

use super::error::Fault;
use super::schema::{SCHEMA, alternatives};
use super::study::StudyConfig;
use super::sweep::{Axis, SweptValue, Target};
use super::tree::{Node, Value};
use super::validate::{self, kinds_with};

/// The tree without its `sweep` and `plot` sections, and the axes.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    pub(super) base: Node,
    pub(super) axes: Vec<Axis>,
    /// Fields of the config that swept fields replace.
    pub(super) replaced: Vec<Replaced>,
}

/// A field that is an alternative to a swept field.
#[derive(Debug, Clone)]
pub(super) struct Replaced {
    pub(super) path: String,
    pub(super) node: Node,
    /// Path of the swept field.
    pub(super) by: String,
}

impl Grid {
    /// The cells of a config and axes. Removes fields from the config that are alternatives to a swept field and are not
    /// swept themselves.
    pub(super) fn new(mut base: Node, axes: Vec<Axis>) -> Self {
        let mut replaced = Vec::new();
        let targets = || axes.iter().flat_map(|axis| &axis.targets);
        for target in targets() {
            for path in alternatives(&target.path) {
                if targets().any(|other| other.path == path) {
                    continue;
                }
                replaced.extend(base.take_at(&path).map(|entry| Replaced {
                    path,
                    node: entry.node,
                    by: target.path.clone(),
                }));
            }
        }
        Self {
            base,
            axes,
            replaced,
        }
    }

    pub(super) fn cells(&self) -> usize {
        self.axes.iter().map(Axis::len).product()
    }

    /// The swept fields, in the order of the config.
    pub(super) fn targets(&self) -> impl Iterator<Item = &Target> + Clone {
        self.axes.iter().flat_map(|axis| &axis.targets)
    }

    /// The swept fields with their values in a cell, in the order of [`Grid::targets`].
    pub(super) fn settings(&self, cell: usize) -> impl Iterator<Item = (&Target, SweptValue)> {
        let rows = self.axes.iter().zip(self.rows_of(cell));
        rows.flat_map(|(axis, row)| axis.targets.iter().zip(axis.row(row).into_owned()))
    }

    /// Row of each axis in a cell.
    pub(super) fn rows_of(&self, cell: usize) -> Vec<usize> {
        let mut faster = self.cells();
        let row = |axis: &Axis| {
            faster /= axis.len();
            cell / faster % axis.len()
        };
        self.axes.iter().map(row).collect()
    }

    /// Number of the cell with these rows of the axes.
    pub(super) fn cell_of(&self, rows: &[usize]) -> usize {
        let axes = self.axes.iter().zip(rows);
        axes.fold(0, |cell, (axis, row)| cell * axis.len() + row)
    }

    /// The swept values of a cell, as in results.
    pub(super) fn coordinates(&self, cell: usize) -> Vec<String> {
        self.settings(cell)
            .map(|(_, setting)| setting.text().into_owned())
            .collect()
    }

    /// The swept values of a cell for a message; empty without a sweep.
    pub(super) fn describe(&self, cell: usize) -> String {
        let pairs = self
            .settings(cell)
            .map(|(target, setting)| format!("{} = {}", target.path, setting.text()));
        pairs.collect::<Vec<_>>().join(", ")
    }

    /// The axis that sets a field, and the field's index among the fields of this axis.
    pub(super) fn axis(&self, path: &str) -> Option<(&Axis, usize)> {
        self.axes.iter().find_map(|axis| {
            let place = axis.targets.iter().position(|target| target.path == path);
            Some((axis, place?))
        })
    }

    /// The tree of a cell. If a path names no field, the error is the incomplete tree with the fault.
    pub(super) fn tree(&self, cell: usize) -> Result<Node, (Node, Fault)> {
        let mut tree = self.base.clone();
        for (target, setting) in self.settings(cell) {
            write_defaults(&mut tree, target);
            if let Err(reason) = tree.set(&target.path, setting.node, &target.span) {
                let reason = missing_parent(&tree, &target.path).unwrap_or(reason);
                let message = format!("the sweep path names nothing: {reason}");
                return Err((tree, Fault::at(&target.span, message).under(&target.path)));
            }
        }
        Ok(tree)
    }

    /// Whether no swept value is a table, a list or a `kind`. Then each value can be validated by itself.
    pub(super) fn has_plain_values(&self) -> bool {
        let mut targets = self.targets();
        let is_plain =
            |value: &SweptValue| !matches!(value.node.value, Value::Table(_) | Value::Array(_));
        let is_kind = |path: &str| path.rsplit('.').next() == Some("kind");
        !targets.any(|target| is_kind(&target.path))
            && self.axes.iter().all(|axis| {
                axis.is_range() || (0..axis.len()).all(|row| axis.row(row).iter().all(is_plain))
            })
    }

    /// The config of a cell whose values have been validated one by one, if that is sufficient; `None` if the cell must be
    /// validated by the schema. `base` is the tree of the grid.
    pub(super) fn quick_config(&self, base: &toml::Value, cell: usize) -> Option<StudyConfig> {
        let mut tree = base.clone();
        for (target, setting) in self.settings(cell) {
            let (parents, last) = target.path.rsplit_once('.').unwrap_or(("", &target.path));
            let mut keys = parents.split('.').filter(|key| !key.is_empty());
            let parent = keys.try_fold(&mut tree, |node, key| match node {
                toml::Value::Table(table) => table.get_mut(key),
                toml::Value::Array(items) => items.get_mut(key.parse::<usize>().ok()?),
                _ => None,
            })?;
            let value = setting.node.to_toml();
            match parent {
                toml::Value::Table(table) => drop(table.insert(last.to_owned(), value)),
                toml::Value::Array(items) => *items.get_mut(last.parse::<usize>().ok()?)? = value,
                _ => return None,
            }
        }
        let config: StudyConfig = tree.try_into().ok()?;
        config.scene.check().ok().map(|()| config)
    }
}

/// Adds the missing tables and lists that contain a swept field, with their defaults.
fn write_defaults(tree: &mut Node, target: &Target) {
    let path = &target.path;
    for (end, _) in path.match_indices('.') {
        let parent = &path[..end];
        if tree.at(parent).is_some() {
            continue;
        }
        let default = validate::at(&SCHEMA, tree, parent).and_then(|schema| schema.get("default"));
        let Some(default) = default.filter(|default| default.is_object() || default.is_array())
        else {
            return;
        };
        let Some(default) = Node::of_default(default, &target.span) else {
            return;
        };
        // If a parent cannot be set, setting the field itself reports the error.
        if tree.set(parent, default, &target.span).is_err() {
            return;
        }
    }
}

/// Reason why a path names no field of a tree although the schema has the field: its table is missing and has no default, or
/// it is of another kind, or it is not a table.
fn missing_parent(tree: &Node, path: &str) -> Option<String> {
    let is_table = |node: &Node| matches!(node.value, Value::Table(_) | Value::Array(_));
    let mut ends = path.match_indices('.').map(|(end, _)| end);
    let end = ends.find(|&end| !tree.at(&path[..end]).is_some_and(is_table))?;
    let (parent, rest) = (&path[..end], &path[end + 1..]);
    let key = rest.split('.').next()?;
    let Some(schema) = validate::at(&SCHEMA, tree, parent) else {
        let (above, key) = parent.rsplit_once('.')?;
        let of_above = validate::at(&SCHEMA, tree, above)?["oneOf"].as_array()?;
        let kinds = kinds_with(of_above, key);
        let own = tree.at(above)?.get("kind")?.as_text()?;
        return (!kinds.is_empty()).then(|| {
            let kinds = kinds.join(" or ");
            format!("`{above}` is of kind {own} here, and `{key}` of it takes kind {kinds}; write it there")
        });
    };
    let variants = schema["oneOf"].as_array().map_or(&[][..], Vec::as_slice);
    let of_kind = match kinds_with(variants, key).as_slice() {
        [] => String::new(),
        kinds => format!(" of kind {}", kinds.join(" or ")),
    };
    let is_list = schema["type"] == "array";
    let is_known = !of_kind.is_empty() || is_list || schema["properties"].get(key).is_some();
    let what = if is_list { "list" } else { "table" };
    is_known.then(|| {
        format!("`{parent}` is no {what} in the config, and has no default that is one; write it there{of_kind}, then sweep its `{key}`")
    })
}
