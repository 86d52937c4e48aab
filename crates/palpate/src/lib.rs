//! Studies of a fingertip that explores a surface, and estimates from recorded readings.
//!
//! | task | function |
//! |---|---|
//! | read a study | [`load`] from a file, [`parse`] from a text with a name |
//! | forecast the models, the number of trials and the run time of a study | [`check`] |
//! | look up the measured coverage of intervals in similar scenes | [`coverage`] |
//! | check that a study requests only possible outputs | [`check_outputs`] |
//! | choose the number of trials from a time budget or a target error | [`plan`] |
//! | find the values of fields that meet a target | [`design`] |
//! | compute how reliably the estimates put objects in order | [`distinguish`] |
//! | run a study | [`run`]; [`Simulation`] for some of its cells, with progress and cancellation |
//! | trace one trial of a cell | [`trace`] |
//! | write the config with all defaults, as a run does | [`resolved`] |
//! | split tables into columns | [`columns`] |
//! | draw a figure from tables as SVG text | [`figure`] of [`Files`] |
//! | test the papers' claims with tables, and make a page of the results | [`report`] |
//! | look up the meaning of a word | [`glossary`] |
//! | get the cutting pattern of a sensor's skin | [`CutPattern`], [`marker_places`] |
//! | estimate from recorded readings, track camera images | [`recorded`], with [`readings`] for numbers and [`frame`] for pixels |
//!
//! The library does not print, exit, read a clock or write files. It reads only files that the caller names, and works
//! without threads (WebAssembly). The program of this name (feature `cli`) adds arguments, files and a terminal.
//!
//! ```
//! let text = r#"
//! name = "a-ball"
//! length_unit = "mm"
//! seed = 1
//! trials = 100
//! [scene]
//! kind = "roll"
//! probe = { kind = "sphere", radius = 10.0 }
//! object = { kind = "sphere", radius = 30.0 }
//! motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
//! noise = { angular_velocity = { kind = "uniform", fraction = 0.05 } }
//! "#;
//! let study = palpate::parse("a-ball.toml", text)?;
//! let ran = palpate::run(&study)?;
//! assert!(ran.cells.to_csv().starts_with("cell,quantity,unit,truth,"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod check;
mod check_json;
mod columns;
mod coverage;
mod ladder_timing;
mod output_check;
mod plan;
mod planner;
mod readings;
mod run_files;
mod shard;
mod simulation;
mod study_options;
mod trace_pass;
mod warnings;

pub use check::{CellGroup, Check, Rungs, check};
pub use columns::{Values, columns, unit_of};
pub use coverage::{Coverage, FAMILY_TABLES, Family, coverage, family_scene};
pub use output_check::check_outputs;
pub use palpate_answers::{
    Answer, AnswerError, Best, Discrimination, Extreme, Field, FieldEffect, Group, Object, Pair,
    Question, Region, RegionColumn, Sensitivity, Sought, TrialCounts, design, distinguish,
    sensitivity,
};
pub use palpate_estimators::{CutPattern, marker_places};
pub use palpate_recorded as recorded;
pub use palpate_report as report;
pub use palpate_report::{Figure, Files, ReportError, Stretch, figure, press_figures};
pub use palpate_scene::{
    Accuracy, Arch, CameraTrace, Ladder, Need, Rung, Scene, SceneTrial, Scenes, Trace, TraceError,
};
pub use palpate_study::config::{self, ConfigError, Study, load, parse};
pub use palpate_study::{
    Column, ColumnType, Quantity, Statistic, Table, Target, TargetError, Unit, Warning, glossary,
};
pub use palpate_sweep::{
    CellStatistics, Clock, Failure, NoThreads, Order, Repeats, RunOptions, Runner, Summary,
    SweepError, SweepOutput,
};
pub use plan::plan;
pub use planner::{FailingCell, Goal, Plan, PlanError};
pub use readings::{frame, readings};
pub use run_files::{resolved, result_columns};
pub use shard::Shard;
pub use simulation::{CellRows, Ran, Simulation, run};
pub use study_options::{press_options, roll_options};
pub use trace_pass::trace;
pub use warnings::{Warnings, warning_files};

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    mod planner;
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
