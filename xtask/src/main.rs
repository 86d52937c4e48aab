//! Development tasks, such as `cargo xtask ci` and `cargo xtask reproduce`.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod baseline;
mod bench_check;
mod book;
mod ci;
mod compare;
mod crate_imports;
mod fuzz;
mod peers;
mod programs;
mod python;
mod reproduce;
mod scale;
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
pub(crate) struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Run all checks that a change must pass: format, lints, tests, docs, licences, results, documents.
    Ci,
    /// Run the studies in sim-configs/, draw their figures and test the papers' claims.
    Reproduce(reproduce::Options),
    /// Test long runs: kill and resume them, fill the disk, and divide a study among the nodes of a local cluster. Each
    /// run must write the same bytes as a run without interruption.
    Scale(scale::Options),
    /// Measure the error and the cost of all contact models; writes results/tradeoff/.
    Tradeoff(tradeoff::Options),
    /// Compare the answers of `palpate design` and `palpate distinguish` for fixed scenes with references; writes
    /// results/answers.csv.
    Answers(programs::AssayOptions),
    /// Compare the intervals and warnings of estimates in random scenes with the true values; writes the tables that
    /// `palpate check` reads.
    Intervals(programs::AssayOptions),
    /// Compare instruction counts and errors with the committed baseline.
    BenchCheck(bench_check::Options),
    /// Compare palpate with other programs on the same tasks; writes results/peers.csv.
    Peers(peers::Options),
    /// Build the wheel of the Python package, install it into a virtual environment, and test it there.
    Python(python::Options),
    /// Fuzz the parsers of files with random inputs.
    Fuzz(fuzz::Options),
    /// Write the glossary, and build the book from README.md and docs/.
    Book,
    /// Check that crates import each other only as ARCHITECTURE.md allows.
    House,
}

fn main() -> ExitCode {
    match run(Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(cli: Cli) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .context("xtask is not in a workspace")?;
    let shell = Shell::new()?;
    shell.change_dir(root);
    match cli.task {
        Task::Ci => ci::run(&shell),
        Task::Reproduce(options) => reproduce::run(&shell, &options),
        Task::Scale(options) => scale::run(&shell, &options),
        Task::Tradeoff(options) => tradeoff::run(&shell, &options),
        Task::Answers(options) => programs::answers(&shell, &options),
        Task::Intervals(options) => programs::intervals(&shell, &options),
        Task::BenchCheck(options) => bench_check::run(&shell, &options),
        Task::Peers(options) => peers::run(&shell, &options),
        Task::Python(options) => python::run(&shell, &options),
        Task::Fuzz(options) => fuzz::run(&shell, &options),
        Task::Book => book::run(&shell),
        Task::House => crate_imports::check(&shell),
    }
}
