//! Development tasks: `cargo xtask ci`, `cargo xtask reproduce`.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod bench_check;
mod ci;
mod compare;
mod extremes;
mod fuzz;
mod house;
mod palpate;
mod peers;
mod readme;
mod reproduce;
mod same_bytes;
mod tools;
mod tradeoff;

use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};
use xshell::Shell;

/// Development tasks of palpate.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Check all that must hold before a change is taken: format, lints, tests, docs, licences, results, README.
    Ci,
    /// Run the studies in sim-configs/, draw their figures and score the papers' claims.
    Reproduce(reproduce::Options),
    /// Run shortened studies on every host that this machine can be, and compare their tables' SHA-256.
    SameBytes(same_bytes::Options),
    /// Measure every ladder of models: error against cost, into results/tradeoff/.
    Tradeoff(tradeoff::Options),
    /// Try every public entry point at its extremes, into results/extremes.csv.
    Extremes(extremes::Options),
    /// Compare instruction counts and accuracy with the committed baseline.
    BenchCheck(bench_check::Options),
    /// Run what a user would pick instead beside our benchmarks, into results/peers.csv.
    Peers(peers::Options),
    /// Feed the readers of files what nobody would write.
    Fuzz(fuzz::Options),
    /// Check which file imports which, and which crate which: no circles.
    House,
}

fn main() -> ExitCode {
    match run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            match error.is::<reproduce::UnknownStudy>() {
                true => ExitCode::from(2),
                false => ExitCode::FAILURE,
            }
        }
    }
}

fn run(cli: Cli) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .context("xtask lies in no workspace")?;
    let shell = Shell::new()?;
    shell.change_dir(root);
    match cli.task {
        Task::Ci => ci::run(&shell),
        Task::Reproduce(options) => reproduce::run(&shell, &options),
        Task::SameBytes(options) => same_bytes::run(&shell, &options),
        Task::Tradeoff(options) => tradeoff::run(&shell, &options),
        Task::Extremes(options) => extremes::run(&shell, &options),
        Task::BenchCheck(options) => bench_check::run(&shell, &options),
        Task::Peers(options) => peers::run(&shell, &options),
        Task::Fuzz(options) => fuzz::run(&shell, &options),
        Task::House => house::run(&shell),
    }
}
