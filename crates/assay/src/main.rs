//! Program by which `cargo xtask` runs the harnesses.
#![allow(clippy::print_stdout)]

use std::fmt::Display;
use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::builder::RangedU64ValueParser;
use clap::{Parser, Subcommand};
use palpate_assay::{accuracy, answers, hot, intervals, ours, tradeoff};
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
    /// Judges the rungs that `auto` takes on random scenes; fails if one errs by more than the tolerance, or costs more
    /// than twice the cheapest that would do.
    Promise {
        /// The table to write.
        #[arg(long)]
        out: PathBuf,
        /// Count instructions instead; the program calls itself so under valgrind.
        #[arg(long, hide = true)]
        counted: bool,
    },
    /// Asks for answers on fixed scenes, and holds them against references; fails if too few are right.
    Answers {
        /// The table to write.
        #[arg(long)]
        out: Option<PathBuf>,
        /// Seeds with which each design is asked.
        #[arg(long, default_value = "20", value_parser = at_least_one())]
        seeds: u64,
        /// Pairs of trials against which each probability is held.
        #[arg(long, default_value = "1000000", value_parser = at_least_one())]
        pairs: u64,
        /// Only scenes whose names hold these words.
        #[arg(long, default_value = "")]
        only: String,
    },
    /// Holds the intervals of EP2 against the truth on random surfaces, of which every fifth is a ball.
    Intervals(Scenes),
    /// Holds the intervals of presses by a camera against the truth on random scenes, with another sensor in every trial.
    CameraIntervals(Scenes),
    /// Holds the intervals and the doubts of presses that are read directly against the truth on random scenes.
    PressIntervals(Scenes),
    /// Writes the table from which `palpate check` tells whether intervals were tested, from those of the harnesses.
    Tested {
        /// Folder of the harnesses' tables.
        #[arg(long)]
        results: PathBuf,
        /// The table to write.
        #[arg(long)]
        out: PathBuf,
    },
    /// Holds the intervals and the doubts of rolls against the truth on random scenes.
    RollIntervals(Scenes),
    /// Holds the doubts of glides against the truth on random surfaces.
    GlideIntervals(Scenes),
    /// Prints the errors of palpate on fixed scenes, as CSV.
    Accuracy,
    /// Prints the instructions of the hot paths, as CSV.
    Instructions {
        /// Run only the path of this name. The program starts itself with this option under valgrind.
        #[arg(long, hide = true)]
        counted: Option<String>,
    },
    /// Times palpate on the tasks of the peers, a line of JSON per rung; or writes the inputs of the peers.
    Ours {
        /// The group of tasks.
        #[arg(required_unless_present = "inputs")]
        group: Option<String>,
        /// Largest error that a rung with a tolerance may have on a task, `TASK=ERROR`; 1e-12 on tasks not named.
        #[arg(long, value_parser = limit)]
        error_at_most: Vec<(String, f64)>,
        /// Folder to write the peers' inputs to; nothing is timed.
        #[arg(long)]
        inputs: Option<PathBuf>,
    },
    /// Counts what each stage of a scene does, for `tradeoff`: draws, derivatives, frames.
    #[cfg(feature = "count")]
    Tallies {
        /// The table to write.
        #[arg(long)]
        out: PathBuf,
    },
    /// Measures every ladder of models: error against cost.
    Tradeoff {
        /// The folder to write to.
        #[arg(long)]
        out: PathBuf,
        /// Table that `tallies` has written.
        #[arg(long)]
        tallies: PathBuf,
        /// Words for the machine, written beside the times.
        #[arg(long)]
        machine: String,
        /// Time each rung only briefly.
        #[arg(long)]
        quick: bool,
        /// Count instructions instead; the program calls itself so under valgrind.
        #[arg(long, hide = true)]
        counted: bool,
    },
    /// Draws the Pareto fronts of a folder that `tradeoff` has filled.
    Fronts {
        /// The folder.
        folder: PathBuf,
    },
}

/// Random scenes whose intervals are held against the truth.
#[derive(clap::Args)]
struct Scenes {
    /// The table to write.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Seed of the scenes and the noise.
    #[arg(long, default_value = "1919")]
    seed: u64,
    /// Number of scenes, of each case where there are several.
    #[arg(long, alias = "surfaces", default_value = "60", value_parser = at_least_one())]
    scenes: u64,
    /// Trials of each scene; before a camera a third where presses calibrate the sensor, and a tenth where the model is
    /// wrong [default: 12 of EP2 and glides, else 300]
    #[arg(long, value_parser = at_least_one())]
    trials: Option<u64>,
    /// Only cases whose names hold each of these words.
    #[arg(long, default_value = "")]
    only: String,
}

impl Scenes {
    /// Scores the chosen cases, prints each score and writes the table of scores. Fails if no case is chosen.
    fn score<S: Serialize + Display>(
        &self,
        trials: u64,
        scores: impl FnOnce(intervals::Options<'_>, fn(&S)) -> Result<Vec<S>>,
    ) -> Result<Vec<S>> {
        let options = intervals::Options {
            seed: self.seed,
            scenes: self.scenes,
            trials: self.trials.unwrap_or(trials),
            only: &self.only,
        };
        let scores = scores(options, |score| println!("{score}"))?;
        if scores.is_empty() {
            bail!("no case has a name that holds each word of `{}`", self.only);
        }
        if let Some(out) = &self.out {
            std::fs::write(out, intervals::table(&scores)?)?;
        }
        Ok(scores)
    }
}

/// Parser of counts of which none would leave nothing to tell.
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
        Harness::Promise { out, counted } => {
            println!("{}", palpate_assay::promise::run(&out, counted)?);
            Ok(())
        }
        Harness::Answers {
            out,
            seeds,
            pairs,
            only,
        } => {
            let options = answers::Options {
                seeds,
                pairs,
                only: &only,
            };
            let scores = answers::scores(options, |score| {
                println!(
                    "{}, {}: {} of {} right",
                    score.command, score.scene, score.right, score.cases
                );
            })?;
            if let Some(out) = out {
                std::fs::write(out, intervals::table(&scores)?)?;
            }
            answers::check(&scores)
        }
        Harness::Intervals(scenes) => {
            let scores = scenes.score(12, intervals::scores)?;
            println!("{}", intervals::summary(&scores));
            Ok(())
        }
        Harness::CameraIntervals(scenes) => {
            let scores = scenes.score(300, intervals::camera::scores)?;
            for summary in intervals::camera::summaries(&scores) {
                println!("{summary}");
            }
            Ok(())
        }
        Harness::PressIntervals(scenes) => scenes.score(300, intervals::press::scores).map(drop),
        Harness::Tested { results, out } => Ok(std::fs::write(
            out,
            intervals::table(&intervals::tested(&results)?)?,
        )?),
        Harness::RollIntervals(scenes) => scenes.score(300, intervals::roll::scores).map(drop),
        Harness::GlideIntervals(scenes) => scenes.score(12, intervals::glide::scores).map(drop),
        Harness::Accuracy => print_figures("error", accuracy::figures()?),
        Harness::Instructions { counted } => match counted {
            Some(path) => hot::count(&path),
            None => print_figures("instructions", hot::counts()?),
        },
        Harness::Ours {
            group,
            error_at_most,
            inputs,
        } => {
            inputs.as_deref().map_or(Ok(()), ours::write_inputs)?;
            for line in group.map_or(Ok(Vec::new()), |group| ours::lines(&group, &error_at_most))? {
                println!("{line}");
            }
            Ok(())
        }
        #[cfg(feature = "count")]
        Harness::Tallies { out } => tradeoff::tallies(&out),
        Harness::Tradeoff {
            out,
            tallies,
            machine,
            quick,
            counted,
        } => tradeoff::run(
            tradeoff::Options {
                out: &out,
                tallies: &tallies,
                machine: &machine,
                quick,
                counted,
            },
            |line| println!("{line}"),
        ),
        Harness::Fronts { folder } => {
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
