//! Errors about a study, with their location in its text.

use super::error::{ConfigError, Fault};
use super::load::Study;
use super::tree::Node;
use std::ops::Range;

impl Study {
    /// Error in a field of a cell that is only found when the config is used, for example a pitch larger than the probe. Its
    /// location is the field, the sweep if that sets the field, or the nearest parent in the text.
    pub fn error_at(&self, cell: usize, path: &str, message: impl Into<String>) -> ConfigError {
        self.error_within(cell, path, None, message.into())
    }

    /// Error outside of the cells: in a plot (`plot.0.y`) or at the top level (`claims.0`).
    pub fn error_beside(&self, path: &str, message: impl Into<String>) -> ConfigError {
        let root = &self.grid.base;
        let node = match path.strip_prefix("plot.") {
            Some(path) => self.plots.nearest(path),
            None => root.nearest(path),
        };
        self.source.error(Fault {
            span: (node.span != root.span && !node.span.is_empty()).then(|| node.span.clone()),
            path: path.into(),
            message: message.into(),
        })
    }

    /// Error in a part of a text field, given by its bytes, for example an unknown name in a formula.
    pub fn error_in_text(
        &self,
        cell: usize,
        path: &str,
        part: Range<usize>,
        message: impl Into<String>,
    ) -> ConfigError {
        self.error_within(cell, path, Some(part), message.into())
    }

    fn error_within(
        &self,
        cell: usize,
        path: &str,
        part: Option<Range<usize>>,
        message: String,
    ) -> ConfigError {
        let tree = self.grid.tree(cell).unwrap_or_else(|(tree, _)| tree);
        let node = tree.nearest(path);
        let span = part
            .and_then(|part| self.part_of(node, part))
            .unwrap_or_else(|| node.span.clone());
        let span = (span != tree.span).then_some(span);
        let error = self.source.error(Fault {
            span,
            path: path.into(),
            message,
        });
        if self.grid.axes.is_empty() {
            error
        } else {
            error.in_cell(cell, &self.grid.describe(cell))
        }
    }

    /// Location of a part of a string in the config's text, if the string has no escapes.
    fn part_of(&self, node: &Node, part: Range<usize>) -> Option<Range<usize>> {
        let written = self.source.text.get(node.span.clone())?;
        let start = node.span.start + written.find(node.as_text()?)?;
        Some(start + part.start..start + part.end)
    }
}
