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
//! | probabilities of distinguishing two objects | a heat map, as a [`Figure`] | [`heat_figure`] |
//! | a number with its standard error for each item | a bar chart, as a [`Figure`] | [`bar_figure`] |
//! | the answer of `palpate design` | a [`Figure`] | [`design_figure`] |
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
    Bars, CurveLine, CurvePoint, DesignChart, DesignCurve, DesignFigure, DesignMap, FieldAxis,
    Figure, Heat, HeatPanel, MapPanel, Stretch, bar_figure, design_figure, figure, figures,
    heat_figure, press_figures, tradeoff_figures,
};
pub use study::Study;
use table::Table;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
