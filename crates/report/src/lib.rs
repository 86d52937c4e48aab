//! Makes plots, scored claims and a self-contained page from tables.
//!
//! A study consists of `cells.csv`, `failures.csv` and `run.toml`, in a folder or in memory ([`Files`]). Some plots
//! also need `map.csv`, or `trace.csv` and `readings.csv`. The crate uses no simulation, no clock and no network. It
//! returns texts and images, and writes no files.
//!
//! | input | output | function |
//! |---|---|---|
//! | [`Files`] | [`Study`] | [`Study::read`] |
//! | a study's `[[plot]]` tables | [`Figure`]s, as SVG and PNG | [`figures`] |
//! | one plot and tables in memory | a [`Figure`] | [`figure`] |
//! | `trace.csv` and `readings.csv` of a press | `quiver` and `trace-profile` | [`press_figures`] |
//! | an answer as an [`AnswerFigure`]: bar chart, heat map, curve or map | a [`Figure`] | [`answer_figure`] |
//! | tables of `cargo xtask tradeoff` | a Pareto front for each comparison of models | [`tradeoff_figures`] |
//! | a study's `claims = [..]` | [`Score`]s, `claims.csv` | [`score`], [`claims_table`] |
//! | several studies | one HTML page, one line per claim for the terminal | [`page`], [`scorecard_lines`] |

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod claims;
mod error;
mod files;
mod interval_coverage;
mod page;
mod page_sections;
mod phrases;
mod plot;
mod records;
mod study;
mod table;
mod tradeoff;

pub use claims::{Score, Verdict, claims_table, is_claim, score, scorecard_lines};
pub use error::ReportError;
pub use files::Files;
pub use page::page;
pub use plot::{
    AnswerChart, AnswerFigure, CurveLine, CurvePoint, FieldAxis, Figure, HeatPanel, MapPanel,
    Stretch, answer_figure, figure, figures, press_figures, tradeoff_figures,
};
pub use study::Study;
use table::Table;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
