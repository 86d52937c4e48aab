//! What `cargo xtask` runs of the harnesses.
#![allow(clippy::print_stdout)]

use std::path::PathBuf;

use anyhow::Result;
use clap::{Parser, Subcommand};
use palpate_assay::tradeoff;

/// Harnesses over the whole of palpate.
#[derive(Parser)]
#[command(name = "palpate-assay")]
struct Cli {
    #[command(subcommand)]
    harness: Harness,
}

#[derive(Subcommand)]
enum Harness {
    /// Tries every public entry point at its extremes; fails if a row breaks a promise.
    Extremes {
        /// The table to write.
        #[arg(long)]
        out: PathBuf,
    },
    /// Measures every ladder of models: error against cost.
    Tradeoff {
        /// The folder to write to.
        #[arg(long)]
        out: PathBuf,
        /// Time as short as may be.
        #[arg(long)]
        quick: bool,
        /// Count instructions: what this program asks of itself under valgrind.
        #[arg(long, hide = true)]
        counted: bool,
    },
    /// Draws the Pareto fronts of a folder that `tradeoff` has filled.
    Fronts {
        /// The folder.
        folder: PathBuf,
    },
}

fn main() -> Result<()> {
    match Cli::parse().harness {
        Harness::Extremes { out } => {
            println!("{}", palpate_assay::extremes::run(&out)?);
            Ok(())
        }
        Harness::Tradeoff {
            out,
            quick,
            counted,
        } => tradeoff::run(
            tradeoff::Options {
                out: &out,
                quick,
                counted,
            },
            |line| println!("{line}"),
        ),
        Harness::Fronts { folder } => {
            for file in palpate_report::draw_tradeoff(&folder)? {
                println!("{}", file.display());
            }
            Ok(())
        }
    }
}
