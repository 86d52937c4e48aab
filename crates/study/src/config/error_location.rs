//! Errors about a study that state a position in the config's text.

use super::error::{ConfigError, Fault, Span};
use super::load::Study;
use super::tree;
use std::ops::Range;

impl Study {
    /// Error in a field of a cell that is found only when the config is used, for example a pitch that is larger than
    /// the probe. The error states the position of the field or, if a sweep sets the field, the position of the swept
    /// value. If the field is missing in the text, the error states the position of the table that would contain the
    /// field.
    pub fn error_at(&self, cell: usize, path: &str, message: impl Into<String>) -> ConfigError {
        self.error_within(cell, path, None, message.into())
    }

    /// Error in a part of the config that does not belong to a cell, for example in a plot (`plot.0.y`) or at the top
    /// level (`claims.0`).
    pub fn error_beside(&self, path: &str, message: impl Into<String>) -> ConfigError {
        self.source.error(Fault::new(message).under(path))
    }

    /// Error in a part of a field whose value is a text, for example an unknown name in a formula. `part` is a byte
    /// range of this text.
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
        let mut fault = self.grid.in_text(cell, Fault::new(message).under(path));
        fault.span = part.and_then(|part| self.part_of(cell, path, &fault.location, part));
        let error = self.source.error(fault);
        if self.grid.axes.is_empty() {
            error
        } else {
            error.in_cell(cell, &self.grid.describe(cell))
        }
    }

    /// Byte range, in the config's text, of a part of a string value. `None` if the string contains escapes, because
    /// positions in the string and in the text then differ.
    fn part_of(&self, cell: usize, path: &str, location: &str, part: Range<usize>) -> Option<Span> {
        let span = self.source.locate(location, false)?;
        let (tree, _) = self.grid.tree(cell);
        let text = tree::at(&tree, path)?.as_str()?;
        let start = span.start + self.source.text.get(span)?.find(text)?;
        Some(start + part.start..start + part.end)
    }
}
