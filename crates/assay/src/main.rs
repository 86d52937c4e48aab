//! What `cargo xtask` runs of the harnesses.
#![allow(clippy::print_stdout)]

use std::path::PathBuf;

use anyhow::Result;
use clap::{Parser, Subcommand};

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
}

fn main() -> Result<()> {
    match Cli::parse().harness {
        Harness::Extremes { out } => {
            println!("{}", palpate_assay::extremes::run(&out)?);
            Ok(())
        }
    }
}
