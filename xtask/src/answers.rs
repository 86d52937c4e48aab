//! Answers of `palpate design` and `palpate distinguish` on fixed scenes, held against references, into
//! `results/answers.csv`. CI asks a part that takes seconds.

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
    /// Only scenes whose names hold these words.
    #[arg(long, default_value = "")]
    only: String,
    /// The table to write.
    #[arg(long, default_value = "results/answers.csv")]
    out: PathBuf,
}

/// The step of CI.
pub(crate) fn check(shell: &Shell) -> Result<()> {
    let options = Options {
        seeds: 5,
        pairs: 100_000,
        only: "cylinder".into(),
        out: palpate::target_dir(shell).join("answers.csv"),
    };
    run(shell, &options)
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let Options {
        seeds,
        pairs,
        only,
        out,
    } = options;
    let (seeds, pairs) = (seeds.to_string(), pairs.to_string());
    let assay = palpate::build(shell, "palpate-assay")?;
    let asked = cmd!(
        shell,
        "{assay} answers --seeds {seeds} --pairs {pairs} --only {only} --out {out}"
    );
    Ok(asked.quiet().run()?)
}
