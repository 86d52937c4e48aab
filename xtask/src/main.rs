//! Development tasks: `cargo xtask ci`, `cargo xtask reproduce`.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod bench_check;
mod ci;
mod cli;
mod compare;
mod fuzz;
mod harness;
mod house;
mod palpate;
mod peers;
mod python;
mod readme;
mod reproduce;
mod scale;
mod tools;
mod tradeoff;

use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::Parser;
use xshell::Shell;

use cli::{Cli, Task};

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
        .context("xtask lies in no workspace")?;
    let shell = Shell::new()?;
    shell.change_dir(root);
    match cli.task {
        Task::Ci => ci::run(&shell),
        Task::Reproduce(options) => reproduce::run(&shell, &options),
        Task::Scale(options) => scale::run(&shell, &options),
        Task::Tradeoff(options) => tradeoff::run(&shell, &options),
        Task::Answers(options) => harness::run(&shell, "answers", &options),
        Task::Intervals(options) => harness::run(&shell, "intervals", &options),
        Task::CameraIntervals(options) => harness::run(&shell, "camera-intervals", &options),
        Task::PressIntervals(options) => harness::run(&shell, "press-intervals", &options),
        Task::RollIntervals(options) => harness::run(&shell, "roll-intervals", &options),
        Task::GlideIntervals(options) => harness::run(&shell, "glide-intervals", &options),
        Task::BenchCheck(options) => bench_check::run(&shell, &options),
        Task::Peers(options) => peers::run(&shell, &options),
        Task::Python(options) => python::run(&shell, &options),
        Task::Fuzz(options) => fuzz::run(&shell, &options),
        Task::House => house::check(&shell),
    }
}
