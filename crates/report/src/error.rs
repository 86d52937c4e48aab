//! Errors while reading, drawing, scoring and writing studies. Each error names the file and the place in the file.

use std::path::PathBuf;

/// Reason why a study could not be read, drawn, scored or written. Each variant names the file; if possible, also the
/// line, column or key, and the value found there.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A file could not be read, written or renamed.
    #[error("{}: {source}", path.display())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A file is not valid CSV: wrong quotation marks, rows with different numbers of fields, or text that is not
    /// UTF-8.
    #[error("{}: {source}", path.display())]
    Csv {
        /// Path of the file.
        path: PathBuf,
        /// Error of the parser, with the line.
        source: csv::Error,
    },
    /// A table is empty, a column is missing or occurs twice, or a cell has a value of the wrong type.
    #[error("{}: {problem}", path.display())]
    BadTable {
        /// Path of the file.
        path: PathBuf,
        /// The problem. If it is in a cell of the table, it states the line, the column and the value.
        problem: String,
    },
    /// `run.toml` is not valid TOML.
    #[error("{}: {source}", path.display())]
    Toml {
        /// Path of the file.
        path: PathBuf,
        /// Error of the parser, with the line and column.
        source: Box<toml::de::Error>,
    },
    /// A `[[plot]]` of `run.toml` is malformed.
    #[error(transparent)]
    Config(#[from] palpate_study::config::ConfigError),
    /// A key of `run.toml` is absent, unknown or of the wrong type.
    #[error("{}: {key}: {problem}", path.display())]
    BadKey {
        /// Path of the file.
        path: PathBuf,
        /// The key, with dots between its parts.
        key: String,
        /// Problem with the key, and its value.
        problem: String,
    },
    /// A plot cannot be drawn from this table.
    #[error("{}: plot {plot:?}: {problem}", path.display())]
    BadPlot {
        /// The `run.toml` that contains the plot.
        path: PathBuf,
        /// Name of the plot.
        plot: String,
        /// Exception for a wrong argument. It contains the position of the wrong number in the array, and this number.
        problem: String,
    },
    /// The drawing library reported an error.
    #[error("{}: drawing failed: {message}", path.display())]
    Draw {
        /// The image that was drawn.
        path: PathBuf,
        /// Error of the drawing library.
        message: String,
    },
    /// The template of the page cannot be rendered.
    #[error("the page's template failed: {0}")]
    Template(#[from] minijinja::Error),
}
