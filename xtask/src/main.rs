//! Development tasks: `cargo xtask ci`, `cargo xtask reproduce`.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod ci;
mod compare;
mod palpate;
mod readme;
mod reproduce;

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
    }
}
