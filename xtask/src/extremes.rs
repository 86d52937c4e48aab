//! Every public entry point at its extremes, into results/extremes.csv.

use anyhow::Result;
use clap::Args;
use xshell::{Shell, cmd};

#[derive(Args)]
pub(crate) struct Options {
    /// The table to write.
    #[arg(long, default_value = "results/extremes.csv")]
    out: std::path::PathBuf,
}

/// Runs the cases, as the tests of palpate-assay do; fails if one breaks a promise.
pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let out = &options.out;
    cmd!(
        shell,
        "cargo run --quiet -p palpate-assay -- extremes --out {out}"
    )
    .quiet()
    .run()?;
    Ok(())
}
