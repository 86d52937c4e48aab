//! Names and formats of the files that palpate writes into a directory.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::anyhow;
use clap::ValueEnum;
use palpate_study::config::{self, Output};
use palpate_study::read_limited;
use toml_parser::Source;
use toml_parser::lexer::{Token, TokenKind};

use crate::failure::Failure;

/// Largest config or manifest that palpate reads, MiB.
pub(crate) const MAX_MIB: u64 = 16;
/// File name of a run's config, which is written next to the run's tables.
pub(crate) const CONFIG: &str = "run.toml";
/// File name of a new run's config, while the directory still contains the tables of an earlier run.
pub(crate) const NEXT_CONFIG: &str = "next-run.toml";
/// File name of the journal of an unfinished run or of a shard.
pub(crate) const JOURNAL: &str = "journal.palpate";
/// File name of the main table of a run.
pub(crate) const CELLS: &str = "cells.csv";
pub(crate) const FAILURES: &str = "failures.csv";
pub(crate) const MAP: &str = "map.csv";
/// File name of the main table in Parquet format. The next two constants are for the tables `failures` and `map`.
pub(crate) const CELLS_PARQUET: &str = "cells.parquet";
pub(crate) const FAILURES_PARQUET: &str = "failures.parquet";
pub(crate) const MAP_PARQUET: &str = "map.parquet";
/// File names of a run's warnings, as lines of text and as JSON. A run without warnings does not write these files.
pub(crate) const WARNINGS: [&str; 2] = ["warnings.txt", "warnings.json"];
/// File name of the main table that `palpate design` writes. The next constants are the names of its other files: the
/// table of a region, the text, the config, and the figure (without extension).
pub(crate) const DESIGN: &str = "design.csv";
pub(crate) const DESIGN_REGION: &str = "region.csv";
pub(crate) const DESIGN_WORDS: &str = "design.txt";
pub(crate) const DESIGN_CONFIG: &str = "design.toml";
pub(crate) const DESIGN_FIGURE: &str = "design";
/// File name of the table that `palpate distinguish` writes. The next constants are the names of its text file and of
/// its figure (without extension).
pub(crate) const DISTINGUISH: &str = "distinguish.csv";
pub(crate) const DISTINGUISH_WORDS: &str = "distinguish.txt";
pub(crate) const DISTINGUISH_FIGURE: &str = "distinguish";
/// File name of the table that `palpate sensitivity` writes. The next constants are the names of its text file and of
/// its figure (without extension).
pub(crate) const SENSITIVITY: &str = "sensitivity.csv";
pub(crate) const SENSITIVITY_WORDS: &str = "sensitivity.txt";
pub(crate) const SENSITIVITY_FIGURE: &str = "sensitivity";
/// File name of the table with the scores of the papers' claims.
pub(crate) const CLAIMS: &str = "claims.csv";
/// File name of the table with the true values of a traced trial. The next constants are the names of the other files
/// of the trace: the readings, the tracked markers, and two camera frames.
pub(crate) const TRACE: &str = "trace.csv";
pub(crate) const READINGS: &str = "readings.csv";
pub(crate) const MARKERS: &str = "markers.csv";
pub(crate) const FRAMES: [&str; 2] = ["rest.png", "pressed.png"];
/// Names of the figures of a traced press, without the extension.
const TRACE_FIGURES: [&str; 2] = ["quiver", "trace-profile"];

/// Whether palpate wrote this config during a run. Such a config states the version of palpate and has no comments.
pub(crate) fn is_run_config(path: &Path) -> bool {
    text_of(path).is_some_and(|text| {
        let is_comment = |token: Token| token.kind() == TokenKind::Comment;
        let has_version = text
            .lines()
            .any(|line| line.starts_with("crate_version = "));
        has_version && !Source::new(&text).lex().any(is_comment)
    })
}

/// Text of the config in a file; `None` if the file cannot be read.
pub(crate) fn text_of(path: &Path) -> Option<String> {
    // Do not open a pipe, because reading it would wait for its writer.
    let is_file = std::fs::metadata(path).is_ok_and(|found| found.is_file());
    let bytes = is_file.then(|| read_limited(path, MAX_MIB).ok())??;
    String::from_utf8(bytes).ok()
}

/// Name of the study in a run's config. The second result contains the names of all files that palpate commands may
/// write into the run's directory.
pub(crate) fn run_files(config: &Path, text: &str) -> (String, Vec<String>) {
    let study = config::parse(&config.display().to_string(), text).ok();
    let writes = |output| {
        let mut studies = study.iter();
        studies.any(|study| study.config.outputs.contains(&output))
    };
    // A config without plots has one default plot.
    let count = |study: &config::Study| study.config.plot.len().max(1);
    let named = |at: usize| {
        let plot = study.as_ref().and_then(|study| study.config.plot.get(at));
        let name = plot.and_then(|plot| plot.name.clone());
        name.unwrap_or(format!("plot-{}", at + 1))
    };
    let figures = (0..study.as_ref().map_or(0, count))
        .map(named)
        .chain(
            TRACE_FIGURES
                .into_iter()
                .filter(|_| writes(Output::Trace))
                .map(str::to_owned),
        )
        .flat_map(|name| [format!("{name}.svg"), format!("{name}.png")]);
    let mut known = vec![CONFIG, NEXT_CONFIG, CLAIMS];
    known.extend(WARNINGS);
    known.extend([CELLS, FAILURES, CELLS_PARQUET, FAILURES_PARQUET]);
    if writes(Output::Map) {
        known.extend([MAP, MAP_PARQUET]);
    }
    if writes(Output::Trace) {
        known.extend([TRACE, READINGS, MARKERS]);
        known.extend(FRAMES);
    }
    let known = known.into_iter().map(str::to_owned).chain(figures);
    let name = study
        .as_ref()
        .map_or("", |study| study.config.name.as_str());
    (name.to_owned(), known.collect())
}

/// File format of tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// CSV, a text format that almost every program can read.
    Csv,
    /// Parquet, a binary format for large tables. It stores the type and the unit of each column.
    Parquet,
}

impl Format {
    pub(crate) const ALL: [Self; 2] = [Self::Csv, Self::Parquet];

    pub(crate) const fn tables(self) -> [&'static str; 3] {
        match self {
            Self::Csv => [CELLS, FAILURES, MAP],
            Self::Parquet => [CELLS_PARQUET, FAILURES_PARQUET, MAP_PARQUET],
        }
    }

    /// Format that the extension of a file name states; `default` if the extension is neither .csv nor .parquet.
    pub(crate) fn of_path(path: &Path, default: Self) -> Self {
        match path.extension().and_then(OsStr::to_str) {
            Some("csv") => Self::Csv,
            Some("parquet") => Self::Parquet,
            _ => default,
        }
    }

    /// Format of the tables in a directory; `None` if the directory has no tables.
    pub(crate) fn found_in(dir: &Path) -> Option<Self> {
        let is_there = |format: &Self| dir.join(format.tables()[0]).is_file();
        Self::ALL.into_iter().find(is_there)
    }

    pub(crate) fn supported(self) -> Result<(), Failure> {
        if self == Self::Csv || cfg!(feature = "parquet") {
            return Ok(());
        }
        Err(Failure::usage(anyhow!(
            "this palpate was built without Parquet; `cargo install --path crates/palpate --features parquet` in its source installs a version with Parquet"
        )))
    }
}
