//! The command line of the tasks.

use clap::{Parser, Subcommand};

use crate::{bench_check, fuzz, harness, peers, python, reproduce, scale, tradeoff};

/// Development tasks of palpate.
#[derive(Parser)]
#[command(name = "cargo xtask")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) task: Task,
}

#[derive(Subcommand)]
pub(crate) enum Task {
    /// Check all that must hold before a change is taken: format, lints, tests, docs, licences, results, README.
    Ci,
    /// Run the studies in sim-configs/, draw their figures and score the papers' claims.
    Reproduce(reproduce::Options),
    /// Kill runs, fill a disk, and share a study on a cluster of this machine: the bytes must be those of one run.
    Scale(scale::Options),
    /// Measure every ladder of models: error against cost, into results/tradeoff/.
    Tradeoff(tradeoff::Options),
    /// Ask for answers on fixed scenes, and hold them against references, into results/answers.csv.
    Answers(harness::Options),
    /// Compare the intervals of EP2 with the truth on random surfaces, into results/intervals.csv.
    Intervals(harness::Options),
    /// Compare the intervals of camera presses with the truth on random scenes, into results/camera-intervals.csv.
    CameraIntervals(harness::Options),
    /// Compare the intervals and warnings of presses without a camera with the truth on random scenes, into
    /// results/press-intervals.csv.
    PressIntervals(harness::Options),
    /// Compare the intervals and warnings of rolls with the truth on random scenes, into results/roll-intervals.csv.
    RollIntervals(harness::Options),
    /// Compare the warnings of glides with the truth on random surfaces, into results/glide-intervals.csv.
    GlideIntervals(harness::Options),
    /// Compare instruction counts and accuracy with the committed baseline.
    BenchCheck(bench_check::Options),
    /// Run what a user would pick instead beside our benchmarks, into results/peers.csv.
    Peers(peers::Options),
    /// Build the wheel of the Python package, install it into an environment of its own, and test it there.
    Python(python::Options),
    /// Feed the readers of files what nobody would write.
    Fuzz(fuzz::Options),
    /// Check that crates import each other only as ARCHITECTURE.md allows.
    House,
}
