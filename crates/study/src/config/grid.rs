//! The cells of a study: every combination of its axes' rows, the first axis slowest.

use super::error::Fault;
use super::sweep::{Axis, SweptValue, Target};
use super::tree::Node;

/// The tree without its `sweep` and `plot` sections, and the axes.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    pub(super) base: Node,
    pub(super) axes: Vec<Axis>,
}

impl Grid {
    pub(super) fn cells(&self) -> usize {
        self.axes.iter().map(|axis| axis.rows.len()).product()
    }

    /// The swept fields, in the order of the config.
    pub(super) fn targets(&self) -> impl Iterator<Item = &Target> + Clone {
        self.axes.iter().flat_map(|axis| &axis.targets)
    }

    /// Fields that a cell sets, with its value for each, in the order of [`Grid::targets`].
    fn settings(&self, cell: usize) -> impl Iterator<Item = (&Target, &SweptValue)> {
        let mut faster = self.cells();
        self.axes.iter().flat_map(move |axis| {
            faster /= axis.rows.len();
            let row = &axis.rows[cell / faster % axis.rows.len()];
            axis.targets.iter().zip(row)
        })
    }

    /// The swept values of a cell as results show them.
    pub(super) fn coordinates(&self, cell: usize) -> Vec<String> {
        self.settings(cell)
            .map(|(_, setting)| setting.text.clone())
            .collect()
    }

    /// The swept values of a cell for a message; empty without a sweep.
    pub(super) fn describe(&self, cell: usize) -> String {
        let pairs = self
            .settings(cell)
            .map(|(target, setting)| format!("{} = {}", target.path, setting.text));
        pairs.collect::<Vec<_>>().join(", ")
    }

    /// The values that a swept field takes, as results show them.
    pub(super) fn texts(&self, path: &str) -> Option<Vec<&str>> {
        self.axes.iter().find_map(|axis| {
            let column = axis.targets.iter().position(|target| target.path == path)?;
            Some(
                axis.rows
                    .iter()
                    .map(|row| row[column].text.as_str())
                    .collect(),
            )
        })
    }

    /// The tree of a cell; or the tree as far as it came, with the fault of the path that names nothing.
    pub(super) fn tree(&self, cell: usize) -> Result<Node, (Node, Fault)> {
        let mut tree = self.base.clone();
        for (target, setting) in self.settings(cell) {
            if let Err(reason) = tree.set(&target.path, setting.node.clone(), &target.span) {
                let message = format!("the sweep path names nothing: {reason}");
                return Err((tree, Fault::at(&target.span, message).under(&target.path)));
            }
        }
        Ok(tree)
    }
}
