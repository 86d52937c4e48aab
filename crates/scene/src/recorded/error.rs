//! Errors of recorded readings.

use thiserror::Error;

/// Readings that cannot be read.
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
    /// A line is wrong: the header lacks a column, a row a field, or a field is no number.
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
    #[error("{array}{}: {message}", shown(index))]
    Array {
        /// The array, as the argument that it is.
        array: &'static str,
        /// Row, and column where there are several, counted from 0; empty of the array as a whole.
        index: Vec<usize>,
        /// The number that is at fault.
        value: Option<f64>,
        /// Problem in words, with the value.
        message: String,
    },
    /// The numbers are readable but tell nothing.
    #[error("{file}: {message}")]
    Readings {
        /// The file.
        file: String,
        /// Problem in words.
        message: String,
    },
}

/// Message with the way to what the kind of an error means; a bad setting says that itself.
pub(super) fn explained(message: String, kind: &str) -> String {
    match kind {
        "bad-setting" => message,
        _ => format!("{message}; see `palpate explain {kind}`"),
    }
}

/// An index in brackets; nothing where there is none.
fn shown(index: &[usize]) -> String {
    let index: Vec<String> = index.iter().map(usize::to_string).collect();
    match index.is_empty() {
        true => String::new(),
        false => format!("[{}]", index.join(", ")),
    }
}
