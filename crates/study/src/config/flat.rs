//! Cells that need not be held against the schema one by one, for their values were.

use super::grid::Grid;
use super::study::StudyConfig;
use super::sweep::SweptValue;
use super::tree::Value;

/// Whether no swept value is a table or a list, and none chooses a kind, on which other fields hang.
pub(super) fn is_flat(grid: &Grid) -> bool {
    let mut targets = grid.targets();
    let is_plain =
        |value: &SweptValue| !matches!(value.node.value, Value::Table(_) | Value::Array(_));
    let is_kind = |path: &str| path.rsplit('.').next() == Some("kind");
    !targets.any(|target| is_kind(&target.path))
        && grid.axes.iter().all(|axis| {
            axis.is_range() || (0..axis.len()).all(|row| axis.row(row).iter().all(is_plain))
        })
}

/// Config of a cell each of whose values has been held against the limits of its field by itself, where that is enough to
/// know that the cell is valid; `None` where it takes the schema to know. `base` is the tree of the grid.
pub(super) fn trusted(base: &toml::Value, grid: &Grid, cell: usize) -> Option<StudyConfig> {
    let mut tree = base.clone();
    for (target, setting) in grid.settings(cell) {
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
