//! Names of the files that palpate writes into a directory.

use std::path::Path;

use palpate_study::config::{self, Output};
use palpate_study::read_limited;
use toml_parser::Source;
use toml_parser::lexer::{Token, TokenKind};

/// Largest config or manifest that is read, MiB.
pub(crate) const MOST_MIB: u64 = 16;
/// Config of a run, beside its tables.
pub(crate) const CONFIG: &str = "run.toml";
/// Config of a run while tables of another config stand there.
pub(crate) const NEXT_CONFIG: &str = "next-run.toml";
/// Journal of a run that has not ended, or of a shard.
pub(crate) const JOURNAL: &str = "journal.palpate";
/// Table without which there are no results.
pub(crate) const CELLS: &str = "cells.csv";
pub(crate) const FAILURES: &str = "failures.csv";
pub(crate) const MAP: &str = "map.csv";
/// Names of the tables as Parquet.
pub(crate) const CELLS_PARQUET: &str = "cells.parquet";
pub(crate) const FAILURES_PARQUET: &str = "failures.parquet";
pub(crate) const MAP_PARQUET: &str = "map.parquet";
/// Warnings of a run, a line each; there is none where there is nothing to warn of.
pub(crate) const WARNINGS: &str = "warnings.txt";
/// Answer of a design: its table, its words and the config that it is of; and the name of its figure.
pub(crate) const DESIGN: &str = "design.csv";
pub(crate) const DESIGN_REGION: &str = "region.csv";
pub(crate) const DESIGN_WORDS: &str = "design.txt";
pub(crate) const DESIGN_CONFIG: &str = "design.toml";
pub(crate) const DESIGN_FIGURE: &str = "design";
/// How surely objects are told apart: the table, its words, and the name of its figure.
pub(crate) const TOLD: &str = "distinguish.csv";
pub(crate) const TOLD_WORDS: &str = "distinguish.txt";
pub(crate) const TOLD_FIGURE: &str = "distinguish";
/// Scores of the claims of a study.
pub(crate) const CLAIMS: &str = "claims.csv";
/// Files of a pass.
pub(crate) const TRACE: &str = "trace.csv";
pub(crate) const READINGS: &str = "readings.csv";
pub(crate) const MARKERS: &str = "markers.csv";
pub(crate) const FRAMES: [&str; 2] = ["rest.png", "pressed.png"];
/// Figures of the pass of a press.
const FIGURES: [&str; 2] = ["quiver", "trace-profile"];

/// Whether a run wrote this config: it states the version of palpate and has no comment, which a run never writes.
pub(crate) fn is_of_a_run(path: &Path) -> bool {
    text_of(path).is_some_and(|text| {
        let is_comment = |token: Token| token.kind() == TokenKind::Comment;
        let has_version = text
            .lines()
            .any(|line| line.starts_with("crate_version = "));
        has_version && !Source::new(&text).lex().any(is_comment)
    })
}

/// Text of a config, if it can be read.
pub(crate) fn text_of(path: &Path) -> Option<String> {
    // To read a pipe would wait for its writer.
    let is_file = std::fs::metadata(path).is_ok_and(|found| found.is_file());
    let bytes = is_file.then(|| read_limited(path, MOST_MIB).ok())??;
    String::from_utf8(bytes).ok()
}

/// Name of the study of a run's config, and names of the files that commands may have written beside it.
pub(crate) fn of_a_run(config: &Path, text: &str) -> (String, Vec<String>) {
    let study = config::parse(&config.display().to_string(), text).ok();
    let writes = |output| {
        let mut studies = study.iter();
        studies.any(|study| study.config.outputs.contains(&output))
    };
    // Without a plot in the config there is a usual one.
    let count = |study: &config::Study| study.config.plot.len().max(1);
    let named = |at: usize| {
        let plot = study.as_ref().and_then(|study| study.config.plot.get(at));
        let name = plot.and_then(|plot| plot.name.clone());
        name.unwrap_or(format!("plot-{}", at + 1))
    };
    let figures = (0..study.as_ref().map_or(0, count))
        .map(named)
        .chain(
            FIGURES
                .into_iter()
                .filter(|_| writes(Output::Trace))
                .map(str::to_owned),
        )
        .flat_map(|name| [format!("{name}.svg"), format!("{name}.png")]);
    let mut known = vec![CONFIG, NEXT_CONFIG, WARNINGS, CLAIMS];
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
