//! Errors while reading, drawing, scoring and writing studies. Each error names the file and the place in the file.

use std::path::PathBuf;

/// Reason why a study could not be read, drawn, scored or written. Each variant names the file and, if possible, the
/// line, the column or the key, and the wrong value.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A file could not be read, written or renamed.
    #[error("{}: {source}", path.display())]
    Io {
        /// Path of the file that could not be read, written or renamed.
        path: PathBuf,
        /// Cause, as the operating system reports it.
        source: std::io::Error,
    },
    /// A file is not valid CSV: its quotation marks are wrong, its rows have different numbers of fields, or it is not
    /// UTF-8.
    #[error("{}: {source}", path.display())]
    Csv {
        /// Path of the invalid CSV file.
        path: PathBuf,
        /// Error of the CSV parser. The text of this error contains the line number.
        source: csv::Error,
    },
    /// A table is empty, a column is missing or occurs twice, or a cell has a value of the wrong type.
    #[error("{}: {problem}", path.display())]
    BadTable {
        /// Path of the file that contains the table.
        path: PathBuf,
        /// Description of the problem. If a cell of the table is wrong, the text states the line, the column and the
        /// value.
        problem: String,
    },
    /// `run.toml` is not valid TOML.
    #[error("{}: {source}", path.display())]
    Toml {
        /// Path of the invalid `run.toml`.
        path: PathBuf,
        /// Error of the TOML parser. The text of this error contains the line and the column.
        source: Box<toml::de::Error>,
    },
    /// A `[[plot]]` table of `run.toml` is invalid.
    #[error(transparent)]
    Config(#[from] palpate_study::config::ConfigError),
    /// A key of `run.toml` is missing, unknown or of the wrong type.
    #[error("{}: {key}: {problem}", path.display())]
    BadKey {
        /// Path of the `run.toml` that contains the key.
        path: PathBuf,
        /// Path of the key, with dots between its parts.
        key: String,
        /// Description of the problem, with the value of the key.
        problem: String,
    },
    /// A plot cannot be drawn from the tables.
    #[error("{}: plot {plot:?}: {problem}", path.display())]
    BadPlot {
        /// Path of the `run.toml` that contains the plot.
        path: PathBuf,
        /// Name of the plot.
        plot: String,
        /// Description of the problem, with the value that causes it.
        problem: String,
    },
    /// The drawing library reported an error.
    #[error("{}: drawing failed: {message}", path.display())]
    Draw {
        /// Name of the image that was being drawn.
        path: PathBuf,
        /// Error message of the drawing library.
        message: String,
    },
    /// The HTML page could not be made from its template.
    #[error("the page's template failed: {0}")]
    Template(#[from] minijinja::Error),
}
