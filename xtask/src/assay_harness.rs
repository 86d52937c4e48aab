//! Runs two test programs of palpate-assay. One compares answers of `palpate design` and `palpate distinguish` with
//! references, the other measures the coverage of intervals.

use anyhow::Result;
use clap::Args;
use xshell::{Shell, cmd};

use crate::programs;

#[derive(Args)]
#[command(disable_help_flag = true)]
pub(crate) struct Options {
    /// Options for the test program. Add --help to list them.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    options: Vec<String>,
}

/// Folder of the tables into which the measured coverage of intervals is written.
const FAMILIES: &str = "crates/palpate/src/coverage";

/// Compares the answers of `design` and `distinguish` with references, and writes `results/answers.csv`.
pub(crate) fn answers(shell: &Shell, options: &Options) -> Result<()> {
    harness(shell, ["answers", "--out", "results/answers.csv"], options)
}

/// Measures the coverage of intervals and the warnings, and writes the measured columns of the tables in [`FAMILIES`].
pub(crate) fn intervals(shell: &Shell, options: &Options) -> Result<()> {
    harness(shell, ["intervals", "--tables", FAMILIES], options)
}

/// A step of CI that compares only some answers with references. It takes a few seconds.
pub(crate) fn check_answers(shell: &Shell) -> Result<()> {
    let table = programs::target_dir(shell).join("answers.csv");
    let options = "--seeds 5 --pairs 100000 --only cylinder".split(' ');
    let options = Options {
        options: options.map(str::to_owned).collect(),
    };
    let table = table.display().to_string();
    harness(shell, ["answers", "--out", &table], &options)
}

fn harness(shell: &Shell, harness: [&str; 3], options: &Options) -> Result<()> {
    let assay = programs::build(shell, "palpate-assay")?;
    let options = &options.options;
    let run = cmd!(shell, "{assay} {harness...} {options...}");
    Ok(run.quiet().run()?)
}
