//! Program that runs the harnesses for `cargo xtask`.
#![allow(clippy::print_stdout)]

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::builder::RangedU64ValueParser;
use clap::{Parser, Subcommand};
use palpate_assay::csv_table::{row_in_words, text};
use palpate_assay::{
    accuracy, answer_check, auto_check, intervals, peer_tasks, tradeoff, workloads,
};
use palpate_report::{Files, tradeoff_figures};
use serde::Serialize;

/// Harnesses over the whole of palpate.
#[derive(Parser)]
#[command(name = "palpate-assay", args_override_self = true)]
struct Cli {
    #[command(subcommand)]
    harness: Harness,
}

#[derive(Subcommand)]
enum Harness {
    /// Checks the models that `auto` chooses on random scenes. Fails if one errs by more than the tolerance, or costs more
    /// than twice as much as the cheapest model within the tolerance.
    AutoCheck {
        /// The table to write.
        #[arg(long)]
        out: PathBuf,
        /// Count instructions instead. The program starts itself with this option under valgrind.
        #[arg(long, hide = true)]
        counted: bool,
    },
    /// Compares answers on fixed scenes with references. Fails if too few are right.
    Answers {
        /// The table to write.
        #[arg(long)]
        out: Option<PathBuf>,
        /// Number of seeds for each scene.
        #[arg(long, default_value = "20", value_parser = at_least_one())]
        seeds: u64,
        /// Number of pairs of trials for each probability.
        #[arg(long, default_value = "1000000", value_parser = at_least_one())]
        pairs: u64,
        /// Only scenes whose names contain these words.
        #[arg(long, default_value = "")]
        only: String,
    },
    /// Compares the intervals of EP2 with the true values on random surfaces, every fifth of them a ball.
    Intervals(Scenes),
    /// Compares the intervals of presses with a camera with the true values on random scenes. Each trial redraws the sensor.
    CameraIntervals(Scenes),
    /// Compares the intervals and warnings of presses without a camera with the true values on random scenes.
    PressIntervals(Scenes),
    /// Writes the table of measured coverages that `palpate check` reads, from the tables of the harnesses.
    CoverageTable {
        /// Folder of the harnesses' tables.
        #[arg(long)]
        results: PathBuf,
        /// The table to write.
        #[arg(long)]
        out: PathBuf,
    },
    /// Compares the intervals and warnings of rolls with the true values on random scenes.
    RollIntervals(Scenes),
    /// Checks the warnings of glides on random surfaces.
    GlideIntervals(Scenes),
    /// Prints the errors of palpate on fixed scenes, as CSV.
    Accuracy,
    /// Prints the instructions of the workloads, as CSV.
    Instructions {
        /// Run only the workload with this name. The program starts itself with this option under valgrind.
        #[arg(long, hide = true)]
        counted: Option<String>,
    },
    /// Times palpate on the tasks of its peers, and prints a line of JSON per rung; or writes the inputs of the peers.
    PeerTasks {
        /// The group of tasks.
        #[arg(required_unless_present = "inputs")]
        group: Option<String>,
        /// Largest error of a rung with a tolerance, `TASK=ERROR`; 1e-12 on other tasks.
        #[arg(long, value_parser = limit)]
        error_at_most: Vec<(String, f64)>,
        /// Write the inputs of the peers to this folder, and time nothing.
        #[arg(long)]
        inputs: Option<PathBuf>,
    },
    /// Counts the work of each stage of a scene for `tradeoff`: draws, derivatives, frames.
    #[cfg(feature = "count")]
    WorkCounts {
        /// The table to write.
        #[arg(long)]
        out: PathBuf,
    },
    /// Measures every ladder of models: error against cost.
    Tradeoff {
        /// The folder to write to.
        #[arg(long)]
        out: PathBuf,
        /// Table from `work-counts`.
        #[arg(long)]
        work_counts: PathBuf,
        /// Description of the machine, written to the tables.
        #[arg(long)]
        machine: String,
        /// Time each rung for a short time only.
        #[arg(long)]
        quick: bool,
        /// Count instructions instead. The program starts itself with this option under valgrind.
        #[arg(long, hide = true)]
        counted: bool,
    },
    /// Draws the Pareto fronts from the tables of `tradeoff`.
    ParetoFronts {
        /// The folder.
        folder: PathBuf,
    },
}

/// Random scenes of a harness of intervals.
#[derive(clap::Args)]
struct Scenes {
    /// The table to write.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Seed of the scenes and the noise.
    #[arg(long, default_value = "1919")]
    seed: u64,
    /// Number of scenes of each case.
    #[arg(long, alias = "surfaces", default_value = "60", value_parser = at_least_one())]
    scenes: u64,
    /// Number of trials of each scene. With a camera, a third of them if presses calibrate the sensor, and a tenth if the
    /// model is wrong [default: 12 of EP2 and glides, else 300]
    #[arg(long, value_parser = at_least_one())]
    trials: Option<u64>,
    /// Only cases whose names contain each of these words.
    #[arg(long, default_value = "")]
    only: String,
}

impl Scenes {
    /// Scores the selected cases, prints each score and writes the table. Fails if no case is selected.
    fn score<S: Serialize>(
        &self,
        trials: u64,
        scores: impl FnOnce(intervals::Options<'_>, fn(&S) -> Result<()>) -> Result<Vec<S>>,
    ) -> Result<Vec<S>> {
        let options = intervals::Options {
            seed: self.seed,
            scenes: self.scenes,
            trials: self.trials.unwrap_or(trials),
            only: &self.only,
        };
        let scores = scores(options, |score| {
            println!("{}", row_in_words(score)?);
            Ok(())
        })?;
        if scores.is_empty() {
            bail!("no case has a name with each word of `{}`", self.only);
        }
        if let Some(out) = &self.out {
            std::fs::write(out, text(&scores)?)?;
        }
        Ok(scores)
    }
}

/// Parser of counts that must not be 0.
fn at_least_one() -> RangedU64ValueParser {
    clap::value_parser!(u64).range(1..)
}

fn limit(text: &str) -> Result<(String, f64), String> {
    let (task, error) = text.rsplit_once('=').ok_or("must be TASK=ERROR")?;
    let error = error.parse().map_err(|_| "the error must be a number")?;
    Ok((task.to_owned(), error))
}

/// Prints names and values as CSV. `figure` is the column name of the values.
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
                std::fs::write(out, text(&scores)?)?;
            }
            answer_check::check(&scores)
        }
        Harness::Intervals(scenes) => {
            let scores = scenes.score(12, intervals::patch::scores)?;
            println!("{}", intervals::patch::summary(&scores));
            Ok(())
        }
        Harness::CameraIntervals(scenes) => {
            let scores = scenes.score(300, intervals::camera::scores)?;
            for summary in intervals::camera::summaries(&scores) {
                println!("{}", row_in_words(&summary)?);
            }
            Ok(())
        }
        Harness::PressIntervals(scenes) => scenes.score(300, intervals::press::scores).map(drop),
        Harness::CoverageTable { results, out } => {
            let table = intervals::coverage_table(&results)?;
            Ok(std::fs::write(out, text(&table)?)?)
        }
        Harness::RollIntervals(scenes) => scenes.score(300, intervals::roll::scores).map(drop),
        Harness::GlideIntervals(scenes) => scenes.score(12, intervals::glide::scores).map(drop),
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
        #[cfg(feature = "count")]
        Harness::WorkCounts { out } => tradeoff::write_work_counts(&out),
        Harness::Tradeoff {
            out,
            work_counts,
            machine,
            quick,
            counted,
        } => tradeoff::run(
            tradeoff::Options {
                out: &out,
                work_counts: &work_counts,
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
