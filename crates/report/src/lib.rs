//! Tables to plots, scored claims and a self-contained page.
//!
//! A study is a folder that holds `cells.csv`, `failures.csv` and `run.toml`, and for some plots `map.csv`, or
//! `trace.csv` and `readings.csv`. Everything here is made from those files and nothing else: no simulation, no
//! clock, no network, no other crate of the workspace.
//!
//! | from | to | by |
//! |---|---|---|
//! | a folder | [`Study`] | [`Study::load`] |
//! | its `[[plot]]` tables | `NAME.svg` and `NAME.png` beside the tables | [`plot`] |
//! | `trace.csv` and `readings.csv` of a press | `quiver` and `trace-profile`, each SVG and PNG | [`draw_press_trace`] |
//! | a folder of `cargo xtask tradeoff` | a Pareto front per ladder, SVG and PNG | [`draw_tradeoff`] |
//! | its `claims = [..]` | [`Score`]s, `claims.csv` | [`score`], [`write_claims`] |
//! | several studies | one HTML page, one text for the terminal | [`write_page`], [`scorecard_text`] |

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod claims;
mod error;
mod file;
mod page;
mod plot;
mod records;
mod scorecard;
mod study;
mod table;
mod tradeoff;
mod words;

pub use claims::{Score, Verdict, score, write_claims};
pub use error::ReportError;
pub use page::{page, write_page};
pub use plot::{draw_press_trace, draw_tradeoff, plot};
pub use scorecard::scorecard_text;
pub use study::{Failure, Study};
pub use table::{Axis, Table};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
