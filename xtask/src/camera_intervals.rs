//! Intervals of presses by a camera on random scenes, held against the truth, into `results/camera-intervals.csv`.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use xshell::{Shell, cmd};

use crate::palpate;

#[derive(Args)]
pub(crate) struct Options {
    /// Seed of the scenes, the sensors and the noise.
    #[arg(long, default_value = "1919")]
    seed: u64,
    /// Number of scenes; 12 with --quick.
    #[arg(long)]
    scenes: Option<u64>,
    /// Trials of each scene; 25 with --quick.
    #[arg(long)]
    trials: Option<u64>,
    /// Few scenes and trials.
    #[arg(long)]
    quick: bool,
    /// Threads that run trials.
    #[arg(long, default_value = "2")]
    threads: u64,
    /// Only scenes whose names hold each of these words.
    #[arg(long, default_value = "")]
    only: String,
    /// The table to write.
    #[arg(long, default_value = "results/camera-intervals.csv")]
    out: PathBuf,
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let [scenes, trials] = if options.quick { [12, 25] } else { [60, 300] };
    let scenes = options.scenes.unwrap_or(scenes).to_string();
    let trials = options.trials.unwrap_or(trials).to_string();
    let Options {
        seed,
        threads,
        only,
        out,
        ..
    } = options;
    let (seed, threads) = (seed.to_string(), threads.to_string());
    let assay = palpate::build(shell, "palpate-assay")?;
    let asked = cmd!(
        shell,
        "{assay} camera-intervals --seed {seed} --scenes {scenes} --trials {trials} --threads {threads} --only {only} --out {out}"
    );
    Ok(asked.quiet().run()?)
}
