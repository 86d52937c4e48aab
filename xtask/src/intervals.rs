//! Intervals of EP2 on random surfaces, held against the truth, into `results/intervals.csv`.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use xshell::{Shell, cmd};

use crate::palpate;

#[derive(Args)]
pub(crate) struct Options {
    /// Seed of the surfaces, the fingers' places and the noise.
    #[arg(long, default_value = "1919")]
    seed: u64,
    /// Surfaces of each case; every fifth is a ball.
    #[arg(long, default_value = "60")]
    surfaces: u64,
    /// Trials on each surface.
    #[arg(long, default_value = "12")]
    trials: u64,
    /// Only cases whose names hold each of these words.
    #[arg(long, default_value = "")]
    only: String,
    /// The table to write.
    #[arg(long, default_value = "results/intervals.csv")]
    out: PathBuf,
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let Options {
        seed,
        surfaces,
        trials,
        only,
        out,
    } = options;
    let (seed, surfaces, trials) = (seed.to_string(), surfaces.to_string(), trials.to_string());
    let assay = palpate::build(shell, "palpate-assay")?;
    let asked = cmd!(
        shell,
        "{assay} intervals --seed {seed} --surfaces {surfaces} --trials {trials} --only {only} --out {out}"
    );
    Ok(asked.quiet().run()?)
}
