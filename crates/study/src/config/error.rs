//! Errors of a config: the problem and its position in the text.

use std::fmt::Write as _;
use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::load::Study;
use super::tree;

/// Byte range in the config's text.
pub(super) type Span = Range<usize>;

/// Error of a config: the problem, the field, and its position in the text.
///
/// ```text
/// study.toml:9:40: scene.object.radius: must be > 0, is -5
///   |
/// 9 | object = { kind = "sphere", radius = -5.0 }
///   |                                      ^^^^
///   = in cell 3: scene.object.radius = -5
/// ```
///
/// ```
/// use palpate_study::config::parse;
///
/// let text = r#"
///     name = "roll-on-a-ball"
///     scene.kind = "roll"
///     scene.probe = { kind = "sphere", radius = 1.0 }
///     scene.object = { kind = "sphere", radius = -5.0 }
///     scene.motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// "#;
/// let error = parse("study.toml", text).expect_err("a radius is positive");
/// assert_eq!(error.path, "scene.object.radius");
/// assert!(error.to_string().starts_with("study.toml:5:"));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {}{message}{details}", if path.is_empty() { String::new() } else { format!("{path}: ") })]
pub struct ConfigError {
    place: String,
    /// Path of the field that has the problem: keys and array indices joined by dots. The path is empty if the error
    /// applies to the whole file.
    pub path: String,
    /// The problem in words, without position and excerpt.
    pub message: String,
    details: String,
}

impl ConfigError {
    pub(super) fn of_file(file: &str, message: impl Into<String>) -> Self {
        Self {
            place: file.into(),
            path: String::new(),
            message: message.into(),
            details: String::new(),
        }
    }

    pub(super) fn of_field(file: &str, path: &str, message: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            ..Self::of_file(file, message)
        }
    }

    /// Adds the number of a cell to the error message, and its swept values. A cell is one combination of the values
    /// that the study sweeps.
    pub(super) fn in_cell(mut self, cell: usize, coordinates: &str) -> Self {
        let indent = " ".repeat(
            self.details
                .lines()
                .nth(1)
                .map_or(1, |line| line.find('|').unwrap_or(1)),
        );
        let _ = write!(self.details, "\n{indent}= in cell {cell}: {coordinates}");
        self
    }
}

/// A problem in a field of the config. The position of the field in the config's text is determined later.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    pub(super) path: String,
    pub(super) message: String,
    /// Path of the value that the excerpt in the message shows. This is the path of the field itself or, if a sweep
    /// sets the field, of the swept value.
    pub(super) location: String,
    /// Whether the excerpt in the message marks the key of the field instead of its value.
    pub(super) is_key: bool,
    /// Position of a syntax error in the config's text, as a byte range.
    pub(super) span: Option<Span>,
}

impl Fault {
    pub(super) fn new(message: impl Into<String>) -> Self {
        Self {
            path: String::new(),
            message: message.into(),
            location: String::new(),
            is_key: false,
            span: None,
        }
    }

    /// A fault which reports that `key` is not allowed.
    pub(super) fn of_key(key: &str, message: impl Into<String>) -> Self {
        Self {
            is_key: true,
            ..Self::new(message).under(key)
        }
    }

    /// Puts `key`, a key or an index, in front of the fault's path and location. This is necessary if the fault was
    /// found in a part of a table, so that its path begins at this part instead of the whole table.
    pub(super) fn under(self, key: impl std::fmt::Display) -> Self {
        let join = |path: &str| match path {
            "" => key.to_string(),
            path => format!("{key}.{path}"),
        };
        Self {
            path: join(&self.path),
            location: join(&self.location),
            ..self
        }
    }

    /// Narrows the fault's location to a part of its field, so that the excerpt shows this part. `part` is the path of
    /// the part within the field.
    pub(super) fn at(self, part: impl std::fmt::Display) -> Self {
        let location = match self.location.as_str() {
            "" => part.to_string(),
            location => format!("{location}.{part}"),
        };
        Self { location, ..self }
    }
}

#[derive(Debug, Clone)]
pub(super) struct Source {
    pub(super) file: String,
    pub(super) text: String,
    /// Whether the config text is the content of a file. If palpate generated the text, this is false, and errors state
    /// no line numbers.
    is_written: bool,
}

/// Largest number of characters of a config line that an excerpt in an error message shows.
const EXCERPT: usize = 120;

impl Source {
    /// Stores the text of a config. A byte order mark at its start is removed.
    pub(super) fn new(file: &str, text: &str) -> Self {
        Self {
            file: file.into(),
            text: text.strip_prefix('\u{feff}').unwrap_or(text).into(),
            is_written: true,
        }
    }

    /// A config text that palpate generated from the config in `file`. Error messages about such a text state no line
    /// numbers, because the user has not seen the text.
    pub(super) fn made(file: &str, text: &str) -> Self {
        Self {
            is_written: false,
            ..Self::new(file, text)
        }
    }

    /// Line number, counted from 1, of the value at `location` in the config file; `None` for a generated text.
    pub(super) fn line(&self, location: &str, is_key: bool) -> Option<usize> {
        let start = self.locate(location, is_key)?.start;
        let lines = self.text[..start].matches('\n').count();
        self.is_written.then_some(lines + 1)
    }

    pub(super) fn error(&self, fault: Fault) -> ConfigError {
        let located = || self.locate(&fault.location, fault.is_key);
        let span = fault.span.clone().or_else(located);
        let (place, details) = match span {
            Some(span) if self.is_written => self.show(&span),
            _ => (self.file.clone(), String::new()),
        };
        ConfigError {
            place,
            path: fault.path,
            message: fault.message,
            details,
        }
    }

    /// Byte range of the value at a path, or of its key. If the text contains only the first keys of the path, the
    /// result is the range of the value of the last key that exists. `None` if not even the first key exists.
    pub(super) fn locate(&self, path: &str, is_key: bool) -> Option<Span> {
        let root = DeValue::Table(DeTable::parse(&self.text).ok()?.into_inner());
        let (mut node, mut rest) = (&root, path);
        let (mut span, mut key_span) = (None, None);
        while !rest.is_empty() {
            // Do not split the path at its dots, because keys may contain dots. Compare each whole key with the
            // beginning of the path instead.
            let after = |key: &str| {
                let after = rest.strip_prefix(key)?;
                (after.is_empty() || after.starts_with('.')).then_some(after)
            };
            let found = match node {
                DeValue::Table(table) => table.iter().find_map(|(key, value)| {
                    Some((Some(key.span()), value, after(key.get_ref())?))
                }),
                DeValue::Array(items) => {
                    let index = rest.split('.').next().unwrap_or_default();
                    let item = index.parse().ok().and_then(|index: usize| items.get(index));
                    item.map(|item| (None, item, &rest[index.len()..]))
                }
                _ => None,
            };
            let Some((key, value, after)) = found else {
                return span;
            };
            (span, key_span) = (Some(value.span()), key);
            (node, rest) = (value.get_ref(), after.strip_prefix('.').unwrap_or(after));
        }
        key_span.filter(|_| is_key).or(span)
    }

    /// Returns two texts: the position as `file:line:column`, and the line of the config with carets under the bytes in
    /// `span`. Line and column (in characters) are counted from 1.
    fn show(&self, span: &Span) -> (String, String) {
        let text = &self.text;
        let start = text.floor_char_boundary(span.start);
        let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let line_end = text[start..]
            .find('\n')
            .map_or(text.len(), |newline| start + newline);
        let line_number = text[..start].matches('\n').count() + 1;
        let column = text[line_start..start].chars().count();
        let line: Vec<char> = text[line_start..line_end]
            .trim_end_matches('\r')
            .chars()
            .collect();
        let end = text.floor_char_boundary(span.end).clamp(start, line_end);
        let width = text[start..end].trim_end().chars().count();

        let first = if line.len() <= EXCERPT {
            0
        } else {
            column.saturating_sub(EXCERPT / 2)
        };
        let last = line.len().min(first + EXCERPT);
        let (head, tail) = (
            if first > 0 { "…" } else { "" },
            if last < line.len() { "…" } else { "" },
        );
        let shown: String = line[first.min(last)..last].iter().collect();
        let before = line[first.min(last)..column.clamp(first.min(last), last)].iter();
        // Keep tabs, because a space in place of a tab would move the caret away from its character.
        let pad: String = head
            .chars()
            .map(|_| ' ')
            .chain(before.map(|&c| if c == '\t' { c } else { ' ' }))
            .collect();
        let carets = "^".repeat(width.min(last.saturating_sub(column)).max(1));
        let gutter = " ".repeat(line_number.to_string().len());
        let details =
            format!("\n{gutter} |\n{line_number} | {head}{shown}{tail}\n{gutter} | {pad}{carets}");
        (
            format!("{}:{line_number}:{}", self.file, column + 1),
            details,
        )
    }
}

/// A problem in a field of a config, without the position of the field in the config's text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path}: {message}")]
pub struct FieldError {
    /// Path of the field that has the problem, such as `scene.object.radius`.
    pub path: String,
    /// Description of the problem in words.
    pub message: String,
    /// Byte range of the wrong part within the field's text; `None` if the whole field is wrong.
    pub part: Option<Range<usize>>,
}

impl FieldError {
    /// Error that applies to the whole field at `path`.
    pub fn at(path: impl Into<String>, message: impl ToString) -> Self {
        Self {
            path: path.into(),
            message: message.to_string(),
            part: None,
        }
    }
}

impl Study {
    /// Error in a part of the config that does not belong to a cell of the study, for example in a plot (`plot.0.y`) or
    /// at the top level (`claims.0`).
    pub fn error_beside(&self, path: &str, message: impl Into<String>) -> ConfigError {
        self.source.error(Fault::new(message).under(path))
    }

    /// Error in a field of a cell (one combination of the swept values), found after the config was validated, for
    /// example a pitch that is larger than the probe. The error states the position of the field in the text. If a
    /// sweep sets the field, it states the position of the swept value. If the field is missing in the text, it states
    /// the position of the table that would contain the field.
    pub fn error_at(&self, cell: usize, error: FieldError) -> ConfigError {
        let FieldError {
            path,
            message,
            part,
        } = error;
        let mut fault = self.grid.in_text(cell, Fault::new(message).under(&path));
        fault.span = part.and_then(|part| self.part_of(cell, &path, &fault.location, part));
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
