//! The cells of a study. A cell combines one row of each sweep axis, and all combinations of rows are cells. The row of
//! the first axis changes slowest.

use super::config_builder;
use super::error::Fault;
use super::field_path::unknown_path;
use super::schema::{SCHEMA, alternatives};
use super::sweep::{Axis, SweptValue, Target};
use super::tree;
use super::validate::{self, kinds_with};
use serde_json::json;
use toml::Value;

/// The sweep axes, and the config as a tree of values without its sections `sweep` and `plot`.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    pub(super) base: Value,
    pub(super) axes: Vec<Axis>,
    /// Fields that were removed from the config because a swept field replaces them.
    pub(super) replaced: Vec<Replaced>,
}

/// A field of the config that a swept field replaces, because both state the same quantity.
#[derive(Debug, Clone)]
pub(super) struct Replaced {
    pub(super) path: String,
    pub(super) value: Value,
    pub(super) by: String,
}

impl Grid {
    /// Creates the grid of cells from the config tree `base` and the sweep axes. If a field is swept, the fields that
    /// state the same quantity in another way are removed from `base`, unless they are swept too.
    pub(super) fn new(mut base: Value, axes: Vec<Axis>) -> Self {
        let mut replaced = Vec::new();
        let targets = || axes.iter().flat_map(|axis| &axis.targets);
        for target in targets() {
            for path in alternatives(&target.path) {
                if targets().any(|other| other.path == path) {
                    continue;
                }
                replaced.extend(tree::take(&mut base, &path).map(|value| Replaced {
                    path,
                    value,
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

    pub(super) fn targets(&self) -> impl Iterator<Item = &Target> + Clone {
        self.axes.iter().flat_map(|axis| &axis.targets)
    }

    pub(super) fn settings(&self, cell: usize) -> impl Iterator<Item = (&Target, SweptValue)> {
        let rows = self.axes.iter().zip(self.rows_of(cell));
        rows.flat_map(|(axis, row)| axis.targets.iter().zip(axis.row(row).into_owned()))
    }

    pub(super) fn rows_of(&self, cell: usize) -> Vec<usize> {
        let mut faster = self.cells();
        let row = |axis: &Axis| {
            faster /= axis.len();
            cell / faster % axis.len()
        };
        self.axes.iter().map(row).collect()
    }

    /// Number of the cell that combines these rows of the sweep axes. `rows` contains one row index per axis.
    pub(super) fn cell_of(&self, rows: &[usize]) -> usize {
        let axes = self.axes.iter().zip(rows);
        axes.fold(0, |cell, (axis, row)| cell * axis.len() + row)
    }

    pub(super) fn coordinates(&self, cell: usize) -> Vec<String> {
        self.settings(cell)
            .map(|(_, setting)| setting.text().into_owned())
            .collect()
    }

    pub(super) fn describe(&self, cell: usize) -> String {
        let pairs = self
            .settings(cell)
            .map(|(target, setting)| format!("{} = {}", target.path, setting.text()));
        pairs.collect::<Vec<_>>().join(", ")
    }

    /// The sweep axis that sets a field, and the index of this field among the fields of the axis; `None` if no axis
    /// sets the field.
    pub(super) fn axis(&self, path: &str) -> Option<(&Axis, usize)> {
        self.axes.iter().find_map(|axis| {
            let place = axis.targets.iter().position(|target| target.path == path);
            Some((axis, place?))
        })
    }

    /// The config tree of a cell of the study, and a fault. If a swept path does not exist, the tree is incomplete, and
    /// the fault states the reason. Otherwise, the fault is `None`.
    pub(super) fn tree(&self, cell: usize) -> (Value, Option<Fault>) {
        let mut tree = self.base.clone();
        // Set the kinds first, because the kind of a table decides which other fields the table has.
        let is_kind = |target: &Target| target.path.ends_with(".kind");
        let (kinds, others): (Vec<_>, Vec<_>) =
            self.settings(cell).partition(|(target, _)| is_kind(target));
        for (target, setting) in kinds.into_iter().chain(others) {
            let path = &target.path;
            let set = add_parents(&mut tree, path).and_then(|()| {
                let set = tree::set(&mut tree, path, setting.value);
                set.map_err(|reason| unknown_path(&tree, path).unwrap_or(reason))
            });
            if let Err(reason) = set {
                let fault = target.fault(format!("the sweep path does not exist: {reason}"));
                let path = path.clone();
                return (tree, Some(Fault { path, ..fault }));
            }
        }
        (tree, None)
    }

    /// Sets the location of a fault in a field of a cell (one combination of the swept values). If a sweep sets the
    /// field, this is the location of the swept value in the `sweep` section. Otherwise, it is the location of the
    /// field in the scene.
    pub(super) fn in_text(&self, cell: usize, mut fault: Fault) -> Fault {
        let path = fault.location.clone();
        for (axis, row) in self.axes.iter().zip(self.rows_of(cell)) {
            for (column, target) in axis.targets.iter().enumerate() {
                match path.strip_prefix(&target.path) {
                    Some("") if fault.is_key => {
                        fault.location.clone_from(&target.location);
                        fault.is_key = target.is_key;
                    }
                    Some(rest) if rest.is_empty() || rest.starts_with('.') => {
                        fault.location = axis.location(row, column) + rest;
                    }
                    _ => {}
                }
            }
        }
        fault
    }

    /// Whether the swept values are plain: no value is a table, a list or a `kind`. Plain values of different fields
    /// can be validated independently of each other.
    pub(super) fn has_plain_values(&self) -> bool {
        let mut targets = self.targets();
        let is_plain =
            |value: &SweptValue| !matches!(value.value, Value::Table(_) | Value::Array(_));
        let is_kind = |path: &str| path.rsplit('.').next() == Some("kind");
        !targets.any(|target| is_kind(&target.path))
            && self.axes.iter().all(|axis| {
                axis.is_range() || (0..axis.len()).all(|row| axis.row(row).iter().all(is_plain))
            })
    }
}

/// Adds the tables and lists on `path` that are missing in the config, because a sweep sets a field in them. An added
/// table or list has its default value; without a default, it is empty. If only one kind of an added table has the
/// swept field, the table gets this kind (its key `kind`). It is an error if the kind remains undetermined, or if the
/// config has another value in place of the table or list.
fn add_parents(root: &mut Value, path: &str) -> Result<(), String> {
    for (end, _) in path.match_indices('.') {
        let parent = &path[..end];
        let found = tree::at(root, parent);
        if matches!(found, Some(Value::Table(_) | Value::Array(_))) {
            continue;
        }
        let Some(schema) = validate::at(&SCHEMA, root, parent) else {
            return other_kind(root, parent).map_or(Ok(()), Err);
        };
        let key = path[end + 1..].split('.').next().unwrap_or_default();
        let kinds = kinds_with(
            schema["oneOf"].as_array().map_or(&[][..], Vec::as_slice),
            key,
        );
        let is_list = schema["type"] == "array";
        let has_any_key = is_list || schema["additionalProperties"].is_object();
        if kinds.is_empty() && !has_any_key && schema["properties"].get(key).is_none() {
            return Ok(());
        }
        let default = schema.get("default");
        let default = default.filter(|default| default.is_object() || default.is_array());
        let value = match (found, default, kinds.as_slice()) {
            (None, Some(default), _) => default.clone(),
            (None, None, []) if !is_list => json!({}),
            (None, None, [_, ..]) if key == "kind" => json!({}),
            (None, None, [kind]) => json!({ "kind": kind }),
            (None, None, [_, ..]) => {
                let kinds = kinds.join(" or ");
                return Err(format!(
                    "`{parent}` is left out in the config; set `{parent}.kind` too: {kinds}"
                ));
            }
            (_, _, kinds) => {
                let what = if is_list { "list" } else { "table" };
                let of_kind = match kinds {
                    [] => String::new(),
                    kinds => format!(" of kind {}", kinds.join(" or ")),
                };
                return Err(format!(
                    "`{parent}` is no {what} in the config; write it there as a {what}{of_kind}"
                ));
            }
        };
        if let Some(value) =
            config_builder::value("", "", &value).map_err(|error| error.to_string())?
        {
            tree::set(root, parent, value)?;
        }
    }
    Ok(())
}

/// Message for a key that exists in other kinds of its table, but not in the stated kind; `None` if no kind has the
/// key.
fn other_kind(root: &Value, path: &str) -> Option<String> {
    let (above, key) = path.rsplit_once('.')?;
    let kinds = kinds_with(
        validate::at(&SCHEMA, root, above)?["oneOf"].as_array()?,
        key,
    );
    let own = tree::at(root, above)?.get("kind")?.as_str()?;
    let needed = kinds.join(" or ");
    (!kinds.is_empty()).then(|| {
        format!("`{above}` is of kind {own}, and only kind {needed} has `{key}`; write it there")
    })
}
