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
    /// A table has no rows (or not even a header).
    #[error("{}: the table is empty", path.display())]
    EmptyTable {
        /// The file.
        path: PathBuf,
    },
    /// A table lacks a column it must have.
    #[error("{}: no column {column:?}; the header has: {}", path.display(), found.join(", "))]
    MissingColumn {
        /// The file.
        path: PathBuf,
        /// The absent column.
        column: String,
        /// The header as found.
        found: Vec<String>,
    },
    /// A table has one column twice.
    #[error("{}: column {column:?} appears twice", path.display())]
    DuplicateColumn {
        /// The file.
        path: PathBuf,
        /// The repeated column.
        column: String,
    },
    /// A cell that must hold a finite number (or a count) holds something else.
    #[error("{}: line {line}, column {column:?}: {value:?} is not {expected}", path.display())]
    BadCell {
        /// The file.
        path: PathBuf,
        /// Line in the file, from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// The cell's text.
        value: String,
        /// Words for the values that are allowed there.
        expected: &'static str,
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
    /// A plot names a column that the table does not have.
    #[error("{}: plot {plot:?}: {key} = {value:?} is no column; known: {}", path.display(), known.join(", "))]
    UnknownColumn {
        /// The `run.toml`.
        path: PathBuf,
        /// Name of the plot.
        plot: String,
        /// The key that names the column.
        key: String,
        /// The unknown name.
        value: String,
        /// The names it could have been, nearest first.
        known: Vec<String>,
    },
    /// Several rows fall on one point of a plot.
    #[error(
        "{}: plot {plot:?}: several rows share {point}; choose by `where`, or spread over `series` or `panels`: {free}",
        path.display()
    )]
    NotUnique {
        /// The `run.toml`.
        path: PathBuf,
        /// Name of the plot.
        plot: String,
        /// The point with several rows.
        point: String,
        /// The axes in which those rows differ.
        free: String,
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
