//! Errors of recorded readings.

use thiserror::Error;

/// Why recorded readings cannot be used.
#[derive(Debug, Error)]
pub enum RecordedError {
    /// The file cannot be opened or is not text.
    #[error("{file}: {message}")]
    File {
        /// The file.
        file: String,
        /// Problem in words.
        message: String,
    },
    /// A line is wrong: the header lacks a column, a row lacks a field, or a field is not a number.
    #[error("{file}:{line}: {message}")]
    Line {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// Problem in words, with the column and the value.
        message: String,
    },
    /// An array of readings is wrong: a number in it, or its length.
    #[error("{array}{}: {message}", brackets(index))]
    Array {
        /// Name of the argument that holds the array.
        array: &'static str,
        /// Row, and column if there are several, counted from 0; empty if the error is in the array as a whole.
        index: Vec<usize>,
        /// The number that is at fault.
        value: Option<f64>,
        /// Problem in words, with the value.
        message: String,
    },
    /// The numbers are readable but determine no estimate.
    #[error("{file}: {message}")]
    Readings {
        /// The file.
        file: String,
        /// Problem in words.
        message: String,
    },
}

impl RecordedError {
    /// An error that concerns a file's readings as a whole.
    pub(super) fn readings(file: impl Into<String>, message: impl Into<String>) -> Self {
        let (file, message) = (file.into(), message.into());
        Self::Readings { file, message }
    }

    /// An error in a line of a file.
    pub(super) fn line(file: &str, line: usize, message: impl Into<String>) -> Self {
        let (file, message) = (file.to_owned(), message.into());
        Self::Line {
            file,
            line,
            message,
        }
    }
}

/// Adds a reference to `palpate explain` to a message, except for bad settings, which need no explanation.
pub(super) fn explained(message: String, kind: &str) -> String {
    match kind {
        "bad-setting" => message,
        _ => format!("{message}; see `palpate explain {kind}`"),
    }
}

/// An index in brackets; nothing if it is empty.
fn brackets(index: &[usize]) -> String {
    let index: Vec<String> = index.iter().map(usize::to_string).collect();
    match index.is_empty() {
        true => String::new(),
        false => format!("[{}]", index.join(", ")),
    }
}
