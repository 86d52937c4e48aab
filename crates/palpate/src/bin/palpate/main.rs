//! The program `palpate`: parses the command line and runs the requested command.
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

use clap::{CommandFactory, FromArgMatches};

use cli::{Cli, Command, ErrorFormat, Estimator, Scheduler};
use failure::Failure;

/// Text that `palpate` prints if it is started without a command.
const FIRST_STEPS: &str = "palpate estimates the curvature of a surface from touch. Four first steps, in a clone of the repository:

  palpate check examples/press-a-ball.toml
      Prints the models of a study, and how long a run takes.
  palpate run examples/press-a-ball.toml && palpate plot out/press-a-ball
      Runs the study and draws its figures.
  palpate design examples/pads-for-a-ball.toml --set arc_length=4 --vary pitch=0.05..2 \\
    --target 'relative_rms_error(mean_curvature) <= 5 %'
      Finds the sensor pitch that meets a target.
  palpate estimate roll examples/roll-readings.csv --probe-radius 10 --pitch 0.2
      Estimates curvature from your own readings.

`palpate help` lists all commands, `palpate help COMMAND` shows examples of one, and
`palpate explain WORD` explains a word.";

fn main() -> ExitCode {
    if std::env::args_os().len() < 2 {
        println!("{FIRST_STEPS}");
        return ExitCode::SUCCESS;
    }
    let parsed = examples_first(Cli::command()).try_get_matches();
    let (command, format) = match parsed.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(Cli {
            command,
            error_format,
        }) => (command, error_format),
        Err(error) if error.use_stderr() && asks_for_json() => {
            let text = error.to_string();
            let message = text.trim().trim_start_matches("error: ");
            output::print_note(failure::error_json("usage", 2, message, None));
            return ExitCode::from(2);
        }
        Err(error) => error.exit(),
    };
    match run(command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            match format {
                ErrorFormat::Text => output::print_note(format_args!("error: {failure}")),
                ErrorFormat::Json => output::print_note(failure.json()),
            }
            failure.exit_code()
        }
    }
}

/// Moves the examples to the beginning of the help text of the command and of each subcommand.
fn examples_first(command: clap::Command) -> clap::Command {
    let command = command.mut_subcommands(examples_first);
    let help = command.get_after_help().map(ToString::to_string);
    let Some((before, examples)) = help.as_deref().and_then(|help| {
        let start = help.find("Example:").or_else(|| help.find("Examples:"))?;
        Some(help.split_at(start))
    }) else {
        return command;
    };
    let (examples, after) = examples.split_once("\n\n").unwrap_or((examples, ""));
    let rest = format!("{before}{after}").trim().to_owned();
    command.before_help(examples.to_owned()).after_help(rest)
}

/// Whether the arguments request errors as JSON. This function also works if clap cannot parse the arguments.
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
        Command::Estimate(Estimator::Force(args)) => estimate::force(&args),
        Command::Sensor(command) => sensor::sensor(&command),
        Command::Design(args) => answer_commands::design(&args),
        Command::Distinguish(args) => answer_commands::distinguish(&args),
        Command::Sensitivity(args) => answer_commands::sensitivity(&args),
        Command::Check(args) => check_command::check(&args),
        Command::Plot(args) => results::plot(&args),
        Command::Report(args) => results::report(&args),
        Command::Schema(args) => schema(args.quantities),
        Command::Explain(args) if args.markdown => explain::glossary(),
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
