//! The `palpate` command line.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "results go to stdout, errors to stderr"
)]

mod budget;
mod c_library;
mod check;
mod cli;
mod duration;
mod estimate;
mod failure;
mod output;
mod progress;
mod results;
mod run;
mod sensor;
mod trace;

use std::process::ExitCode;

use clap::Parser;

use cli::{Cli, Command, Estimator};
use failure::Failure;

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Run(args) => run::run(&args),
        Command::Trace(args) => trace::trace(&args),
        Command::Estimate(Estimator::Roll(args)) => estimate::roll(&args),
        Command::Estimate(Estimator::Glide(args)) => estimate::glide(&args),
        Command::Estimate(Estimator::Press(args)) => estimate::press(&args),
        Command::Sensor(command) => sensor::sensor(&command),
        Command::Check(args) => check::check(&args),
        Command::Plot(args) => results::plot(&args),
        Command::Report(args) => results::report(&args),
        Command::Schema => schema(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            failure.exit_code()
        }
    }
}

fn schema() -> Result<(), Failure> {
    let schema =
        serde_json::to_string_pretty(&palpate_study::config::schema()).map_err(Failure::work)?;
    output::print(&schema)
}
