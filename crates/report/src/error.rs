//! Errors of reading, drawing, scoring and writing studies, each with the place where something is wrong.

use std::path::PathBuf;

/// Reason for which a study could not be read, drawn, scored or written. Each variant names the file and, where there
/// is one, the line, column or key, and the value found there.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A file could not be read, written or renamed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A file is not CSV: bad quoting, a row of another length, not UTF-8.
    #[error("{}: {source}", path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// Error of the parser, with the line.
        source: csv::Error,
    },
    /// A table is empty, lacks a column or has one twice, or a cell has a value of another type.
    #[error("{}: {problem}", path.display())]
    BadTable {
        /// The file.
        path: PathBuf,
        /// Problem with the table, with the line, the column and the value of a cell.
        problem: String,
    },
    /// `run.toml` is not TOML.
    #[error("{}: {source}", path.display())]
    Toml {
        /// The file.
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
        /// The file.
        path: PathBuf,
        /// The key, dotted.
        key: String,
        /// Problem with the key, and its value.
        problem: String,
    },
    /// A plot cannot be drawn from this table.
    #[error("{}: plot {plot:?}: {problem}", path.display())]
    BadPlot {
        /// The `run.toml`.
        path: PathBuf,
        /// Name of the plot.
        plot: String,
        /// Problem with the plot, and the value that causes it.
        problem: String,
    },
    /// The drawing library failed.
    #[error("{}: drawing failed: {message}", path.display())]
    Draw {
        /// The picture.
        path: PathBuf,
        /// Error of the drawing library.
        message: String,
    },
    /// The page's template failed.
    #[error("the page's template failed: {0}")]
    Template(#[from] minijinja::Error),
}
