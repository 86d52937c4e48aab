//! The `palpate` command line.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "results go to stdout, errors to stderr"
)]

mod answer_commands;
mod budget;
mod check_command;
mod cli;
mod duration;
mod estimate;
mod explain;
mod failure;
mod journal;
mod merge;
mod output;
mod progress;
mod results;
mod run;
mod sensor;
mod status;
mod submit;

use std::process::ExitCode;

use clap::Parser;

use cli::{Cli, Command, ErrorFormat, Estimator, Scheduler};
use failure::Failure;

fn main() -> ExitCode {
    let (command, format) = match Cli::try_parse() {
        Ok(Cli {
            command,
            error_format,
        }) => (command, error_format),
        Err(error) if error.use_stderr() && asks_for_json() => {
            let text = error.to_string();
            let message = text.trim().trim_start_matches("error: ");
            eprintln!("{}", failure::error_json("usage", 2, message, None));
            return ExitCode::from(2);
        }
        Err(error) => error.exit(),
    };
    match run(command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            match format {
                ErrorFormat::Text => eprintln!("error: {failure}"),
                ErrorFormat::Json => eprintln!("{}", failure.json()),
            }
            failure.exit_code()
        }
    }
}

/// Whether arguments that cannot be read ask for errors as JSON.
fn asks_for_json() -> bool {
    let arguments: Vec<_> = std::env::args_os().collect();
    let mut pairs = arguments.windows(2);
    arguments.iter().any(|one| one == "--error-format=json")
        || pairs.any(|pair| pair[0] == "--error-format" && pair[1] == "json")
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Run(args) => run::run(&args),
        Command::Merge(args) => merge::merge(&args),
        Command::Status(args) => status::status(&args),
        Command::Submit(Scheduler::Slurm(args)) => submit::slurm(&args),
        Command::Trace(args) => results::trace(&args),
        Command::Estimate(Estimator::Roll(args)) => estimate::roll(&args),
        Command::Estimate(Estimator::Glide(args)) => estimate::glide(&args),
        Command::Estimate(Estimator::Press(args)) => estimate::press(&args),
        Command::Sensor(command) => sensor::sensor(&command),
        Command::Design(args) => answer_commands::design(&args),
        Command::Distinguish(args) => answer_commands::distinguish(&args),
        Command::Check(args) => check_command::check(&args),
        Command::Plot(args) => results::plot(&args),
        Command::Report(args) => results::report(&args),
        Command::Schema(args) => schema(args.quantities),
        Command::Explain(args) => explain::explain(&args.term.join(" ")),
    }
}

fn schema(lists_quantities: bool) -> Result<(), Failure> {
    if lists_quantities {
        return explain::quantities();
    }
    let schema =
        serde_json::to_string_pretty(&palpate_study::config::schema()).map_err(Failure::work)?;
    output::print(&schema)
}
