//! Formats of tables.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::anyhow;
use clap::ValueEnum;

use super::names::{CELLS, CELLS_PARQUET, FAILURES, FAILURES_PARQUET, MAP, MAP_PARQUET};
use crate::failure::Failure;

/// Format of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Text, which every program reads.
    Csv,
    /// Columns with types and units, for programs that read large tables.
    Parquet,
}

impl Format {
    /// All formats.
    pub(crate) const ALL: [Self; 2] = [Self::Csv, Self::Parquet];

    /// Names of the tables of cells, failures and maps.
    pub(crate) const fn tables(self) -> [&'static str; 3] {
        match self {
            Self::Csv => [CELLS, FAILURES, MAP],
            Self::Parquet => [CELLS_PARQUET, FAILURES_PARQUET, MAP_PARQUET],
        }
    }

    /// Format that the ending of a file's name asks for; `default` where it asks for none.
    pub(crate) fn of_path(path: &Path, default: Self) -> Self {
        match path.extension().and_then(OsStr::to_str) {
            Some("csv") => Self::Csv,
            Some("parquet") => Self::Parquet,
            _ => default,
        }
    }

    /// Format of the tables of a run in a directory, if it has one.
    pub(crate) fn found_in(dir: &Path) -> Option<Self> {
        let is_there = |format: &Self| dir.join(format.tables()[0]).is_file();
        Self::ALL.into_iter().find(is_there)
    }

    /// Refuses a format that this program was built without.
    pub(crate) fn supported(self) -> Result<(), Failure> {
        if self == Self::Csv || cfg!(feature = "parquet") {
            return Ok(());
        }
        Err(Failure::usage(anyhow!(
            "this palpate was built without Parquet; `cargo install --path crates/palpate --features parquet` in its source \
             installs one with it"
        )))
    }
}
