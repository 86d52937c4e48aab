//! The error type for files that cannot be read, and for readings that do not determine an estimate.

use thiserror::Error;

/// Reason why recorded readings cannot be read from a file, or why no estimate can be computed from them.
#[derive(Debug, Error)]
pub enum RecordedError {
    /// The file cannot be opened or is not text.
    #[error("{file}: {message}")]
    File {
        /// Name of the file.
        file: String,
        /// Text that states the problem with the file.
        message: String,
    },
    /// A line of a file is wrong: the header lacks a column, a row lacks a field, or a field is not a number.
    #[error("{file}:{line}: {message}")]
    Line {
        /// Name of the file.
        file: String,
        /// Number of the wrong line, counted from 1.
        line: usize,
        /// Description of the problem, with the column and the value.
        message: String,
    },
    /// An array of readings is wrong: either its length or a number in it.
    #[error("{array}{}: {message}", brackets(index))]
    Array {
        /// Name of the argument that contains the array.
        array: &'static str,
        /// Index of the wrong number in the array, counted from 0: its row and, if there are several columns, its
        /// column. The list is empty if the array as a whole is wrong.
        index: Vec<usize>,
        /// The wrong number; `None` if the array as a whole is wrong.
        value: Option<f64>,
        /// Description of the problem, with the wrong value.
        message: String,
    },
    /// The numbers in a file are valid, but no estimate can be computed from these numbers.
    #[error("{file}: {message}")]
    Readings {
        /// Name of the file.
        file: String,
        /// Text that states the problem with the readings.
        message: String,
    },
}

impl RecordedError {
    pub(super) fn readings(file: impl Into<String>, message: impl Into<String>) -> Self {
        let (file, message) = (file.into(), message.into());
        Self::Readings { file, message }
    }

    pub(super) fn line(file: &str, line: usize, message: impl Into<String>) -> Self {
        let (file, message) = (file.to_owned(), message.into());
        Self::Line {
            file,
            line,
            message,
        }
    }
}

/// Adds a reference to the command `palpate explain` to a message about an error of the kind `kind`. A message about an
/// invalid setting needs no explanation and stays unchanged.
pub(super) fn explained(message: String, kind: &str) -> String {
    match kind {
        "bad-setting" => message,
        _ => format!("{message}; see `palpate explain {kind}`"),
    }
}

fn brackets(index: &[usize]) -> String {
    let index: Vec<String> = index.iter().map(usize::to_string).collect();
    match index.is_empty() {
        true => String::new(),
        false => format!("[{}]", index.join(", ")),
    }
}
