//! Answers of `palpate design` and `palpate distinguish` on fixed scenes, held against references, into
//! `results/answers.csv`. Tests ask a part that takes seconds.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use xshell::{Shell, cmd};

use crate::palpate;

#[derive(Args)]
pub(crate) struct Options {
    /// Seeds with which each design is asked.
    #[arg(long, default_value = "20")]
    seeds: u64,
    /// Pairs of trials against which each probability is held.
    #[arg(long, default_value = "1000000")]
    pairs: u64,
    /// The table to write.
    #[arg(long, default_value = "results/answers.csv")]
    out: PathBuf,
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let Options { seeds, pairs, out } = options;
    let (seeds, pairs) = (seeds.to_string(), pairs.to_string());
    let assay = palpate::build(shell, "palpate-assay")?;
    let asked = cmd!(
        shell,
        "{assay} answers --seeds {seeds} --pairs {pairs} --out {out}"
    );
    Ok(asked.quiet().run()?)
}
