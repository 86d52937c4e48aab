//! The program with which `cargo xtask` runs the tests of this crate.
#![allow(clippy::print_stdout)]

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::builder::RangedU64ValueParser;
use clap::{Parser, Subcommand};
use palpate::FAMILY_TABLES;
use palpate_assay::{
    accuracy, answer_check, auto_check, csv_table, intervals, peer_tasks, tradeoff, workloads,
};
use palpate_report::{Files, tradeoff_figures};

/// Test programs for palpate as a whole.
#[derive(Parser)]
#[command(name = "palpate-assay", args_override_self = true)]
struct Cli {
    #[command(subcommand)]
    harness: Harness,
}

#[derive(Subcommand)]
enum Harness {
    /// Checks the models that `auto` chooses on random scenes. Fails if a chosen model has an error above the
    /// tolerance, or costs more than twice as much as the cheapest model within the tolerance.
    AutoCheck {
        /// Write the results to this table.
        #[arg(long)]
        out: PathBuf,
        /// Run only the computations whose instructions valgrind counts. The program sets this option when it starts
        /// itself under valgrind.
        #[arg(long, hide = true)]
        counted: bool,
    },
    /// Compares answers on fixed scenes with references. Fails if too few answers are right.
    Answers {
        /// Write the results to this table.
        #[arg(long)]
        out: Option<PathBuf>,
        /// Number of seeds for each scene.
        #[arg(long, default_value = "20", value_parser = at_least_one())]
        seeds: u64,
        /// Number of pairs of fresh trials that test each probability.
        #[arg(long, default_value = "1000000", value_parser = at_least_one())]
        pairs: u64,
        /// Run only scenes whose names contain these words.
        #[arg(long, default_value = "")]
        only: String,
    },
    /// Compares the intervals and warnings of random scenes with the true values, and writes the measured columns of
    /// the tables that `palpate check` reads. Fails if readings without a flaw cause too many warnings, or if readings
    /// with a flaw cause too few warnings.
    Intervals(Intervals),
    /// Prints the errors of palpate on fixed scenes, as CSV.
    Accuracy,
    /// Prints the number of processor instructions of each workload, as CSV.
    Instructions {
        /// Run only the workload with this name. The program sets this option when it starts itself under valgrind.
        #[arg(long, hide = true)]
        counted: Option<String>,
    },
    /// Measures the time of palpate on tasks that other programs (its peers) also solve, and prints a line of JSON per
    /// model. With --inputs, writes the inputs of the peers instead.
    PeerTasks {
        /// Group of tasks to measure.
        #[arg(required_unless_present = "inputs")]
        group: Option<String>,
        /// Largest allowed error of a model on a task, as `TASK=ERROR`. Without this option, the limit is 1e-12. A
        /// model with a tolerance uses the largest tolerance with which its error is within this limit.
        #[arg(long, value_parser = limit)]
        error_at_most: Vec<(String, f64)>,
        /// Write the inputs of the peers to this folder, and measure nothing.
        #[arg(long)]
        inputs: Option<PathBuf>,
    },
    /// Measures the error and the cost of each model, each sensor and each setting, for the trade-off tables.
    Tradeoff {
        /// Write the tables to this folder.
        #[arg(long)]
        out: PathBuf,
        /// Description of the machine, which is written to the tables.
        #[arg(long)]
        machine: String,
        /// Measure the time of each model only briefly.
        #[arg(long)]
        quick: bool,
        /// Run only the computations whose instructions valgrind counts. The program sets this option when it starts
        /// itself under valgrind.
        #[arg(long, hide = true)]
        counted: bool,
    },
    /// Draws Pareto fronts from the tables that `tradeoff` has written.
    ParetoFronts {
        /// Folder with the tables.
        folder: PathBuf,
    },
}

#[derive(clap::Args)]
struct Intervals {
    /// Names of the tables whose families of scenes are measured: roll, glide, press, image; all by default.
    names: Vec<String>,
    /// Folder of the tables.
    #[arg(long)]
    tables: PathBuf,
    /// Seed of the scenes and the noise.
    #[arg(long, default_value = "1919")]
    seed: u64,
    /// Number of scenes of each family of scenes, instead of the number that the table states.
    #[arg(long, value_parser = at_least_one())]
    scenes: Option<u64>,
    /// Number of trials of each scene, instead of the number that the table states.
    #[arg(long, value_parser = at_least_one())]
    trials: Option<u64>,
    /// Measure only families of scenes whose names or flaws contain each of these words. A flaw is a mistake in the
    /// simulated readings. The rows of other families in the tables do not change.
    #[arg(long, default_value = "")]
    only: String,
}

impl Intervals {
    fn measure(&self) -> Result<()> {
        let options = intervals::Options {
            seed: self.seed,
            scenes: self.scenes,
            trials: self.trials,
            only: &self.only,
        };
        let is_selected =
            |name: &str| self.names.is_empty() || self.names.iter().any(|one| one == name);
        let mut misses = Vec::new();
        for (name, _) in FAMILY_TABLES.iter().filter(|(name, _)| is_selected(name)) {
            let path = self.tables.join(format!("{name}.csv"));
            let table = std::fs::read_to_string(&path)?;
            let (text, of_table) = intervals::measure(&table, options, |line| println!("{line}"))?;
            std::fs::write(path, text)?;
            misses.extend(of_table);
        }
        match misses.is_empty() {
            true => Ok(()),
            false => bail!(
                "some families violate the limits on warnings:\n{}",
                misses.join("\n")
            ),
        }
    }
}

fn at_least_one() -> RangedU64ValueParser {
    clap::value_parser!(u64).range(1..)
}

fn limit(text: &str) -> Result<(String, f64), String> {
    let (task, error) = text.rsplit_once('=').ok_or("must be TASK=ERROR")?;
    let error = error.parse().map_err(|_| "the error must be a number")?;
    Ok((task.to_owned(), error))
}

/// Prints names and values as CSV. `figure` is the header of the column of values.
fn print_figures(figure: &str, figures: Vec<(String, f64)>) -> Result<()> {
    let mut writer = csv::Writer::from_writer(std::io::stdout());
    writer.write_record(["name", figure])?;
    for (name, figure) in figures {
        writer.write_record([name, format!("{figure:e}")])?;
    }
    Ok(writer.flush()?)
}

fn main() -> Result<()> {
    match Cli::parse().harness {
        Harness::AutoCheck { out, counted } => {
            println!("{}", auto_check::run(&out, counted)?);
            Ok(())
        }
        Harness::Answers {
            out,
            seeds,
            pairs,
            only,
        } => {
            let options = answer_check::Options {
                seeds,
                pairs,
                only: &only,
            };
            let scores = answer_check::scores(options, |score| {
                println!(
                    "{}, {}: {} of {} right",
                    score.command, score.scene, score.right, score.cases
                );
            })?;
            if let Some(out) = out {
                csv_table::write(&out, scores.iter().map(answer_check::Score::columns))?;
            }
            answer_check::check(&scores)
        }
        Harness::Intervals(intervals) => intervals.measure(),
        Harness::Accuracy => print_figures("error", accuracy::figures()?),
        Harness::Instructions { counted } => match counted {
            Some(name) => workloads::count(&name),
            None => print_figures("instructions", workloads::counts()?),
        },
        Harness::PeerTasks {
            group,
            error_at_most,
            inputs,
        } => {
            inputs.as_deref().map_or(Ok(()), peer_tasks::write_inputs)?;
            for line in group.map_or(Ok(Vec::new()), |group| {
                peer_tasks::lines(&group, &error_at_most)
            })? {
                println!("{line}");
            }
            Ok(())
        }
        Harness::Tradeoff {
            out,
            machine,
            quick,
            counted,
        } => tradeoff::run(
            tradeoff::Options {
                out: &out,
                machine: &machine,
                quick,
                counted,
            },
            |line| println!("{line}"),
        ),
        Harness::ParetoFronts { folder } => {
            for figure in tradeoff_figures(&Files::in_folder(&folder))? {
                for (ending, bytes) in [("svg", figure.svg.as_bytes()), ("png", &figure.png()?)] {
                    let file = folder.join(format!("{}.{ending}", figure.name));
                    std::fs::write(&file, bytes)?;
                    println!("{}", file.display());
                }
            }
            Ok(())
        }
    }
}
