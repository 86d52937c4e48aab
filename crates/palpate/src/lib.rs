//! Studies of a fingertip that explores a surface, and estimates from readings that somebody measured.
//!
//! | to | call |
//! |---|---|
//! | read a study | [`load`] from a file, [`parse`] from a text with a name |
//! | see what it will do | [`check`] |
//! | know whether intervals of such scenes were held against the truth | [`tested`] |
//! | refuse what it asks for and cannot have | [`refuse`] |
//! | choose its trials from a budget of time or a target error | [`plan`] |
//! | find the values of a field that meet a target | [`design`] |
//! | tell how surely its objects are told apart | [`distinguish`] |
//! | run it | [`run`]; [`Simulation`] for some of its cells, with progress and cancellation |
//! | follow one pass of a cell | [`trace`] |
//! | write its config as a run does | [`resolved`] |
//! | take tables apart | [`columns`], [`columns_of_csv`] |
//! | draw a figure of tables as SVG text | [`figure`] of [`Files`] |
//! | score the papers' claims on tables, and make their page | [`report`] |
//! | know what a word means | [`glossary`] |
//! | cut the skin of a sensor | [`CutPattern`], [`marker_places`] |
//! | estimate from recorded readings, track camera images | [`recorded`], with [`readings`] for numbers and [`frame`] for pixels |
//!
//! Nothing here prints, exits, reads a clock or writes a file; only files that the caller names are read. It runs where
//! there are no threads (WebAssembly). The program of this name (feature `cli`) adds arguments, files and a terminal.
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

mod asked;
mod check;
mod columns;
mod costs;
mod design;
mod distinguish;
mod facts;
mod map;
mod means;
mod plan;
mod readings;
mod region;
mod resolved;
mod share;
mod simulation;
pub mod study_options;
mod tables;
mod tested;
mod trace;
mod trial;

pub use asked::refuse;
pub use check::{CellGroup, Check, Rungs, check};
pub use columns::{Column, ColumnType, ValueKind, Values, columns, columns_of_csv};
pub use costs::Cost;
pub use design::{Answer, DesignError, Field, LookedAt, Question, Sample, design};
pub use distinguish::{DistinguishError, Group, Object, Pair, ToldApart, distinguish};
pub use map::Map;
pub use palpate_recorded as recorded;
pub use palpate_report as report;
pub use palpate_report::{Figure, Files, ReportError, figure, press_figures};
pub use palpate_scene::{
    Accuracy, Arch, CameraTrace, CutPattern, Ladder, Need, Rung, Scene, Scenes, Trace,
    marker_places,
};
pub use palpate_study::config::{self, ConfigError, Study, load, parse};
pub use palpate_study::{Quantity, Statistic, Table, Target, TargetError, Unit, Warning, glossary};
pub use palpate_sweep::{
    CellStatistics, Clock, EndReason, FailingCell, Failure, Goal, MODEL_ERROR_SHARE, NoThreads,
    Order, Plan, PlanError, Repeats, Run, RunOptions, Runner, Side, Summary, SweepError,
    SweepOutput,
};
pub use plan::plan;
pub use readings::{frame, readings};
pub use region::{Best, Extreme, Region, RegionColumn, Sought, Survey, region};
pub use resolved::resolved;
pub use share::Shard;
pub use simulation::{CellRows, Finished, Ran, RunError, Simulation, Warnings, run};
pub use tested::{Family, Tested, tested};
pub use trace::{TraceError, trace};
pub use trial::SceneTrial;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
