//! Configs of studies, quantities with their units, and tables of results. This crate contains no physics.
//!
//! [`config`] parses a TOML text to a validated [`config::Study`]. A study consists of cells; each cell is one
//! combination of the values that the study sweeps. A [`Quantity`] describes a number that the trials determine, with
//! its [`Unit`]. A [`Statistic`] summarises the estimates of a quantity over the trials. A [`Label`] describes a column
//! in words. A [`Table`] stores results; [`number`](mod@number) formats its numbers. [`readings`] defines the columns
//! of recorded readings. The [`glossary`] explains terms.

mod bounded_read;
pub mod config;
pub mod glossary;
pub mod label;
pub mod number_text;
mod quantity;
pub mod readings;
mod statistic;
mod table;
mod target;
mod warning;

pub use bounded_read::{read_all, read_limited};
pub use config::FieldError;
pub use label::Label;
pub use number_text::{self as number, shortest as number};
pub use quantity::{Quantity, QuantityKind, Unit};
pub use statistic::Statistic;
pub use table::{Column, ColumnType, Rows, Table, push_row};
pub use target::{Bound, Target, TargetError};
pub use warning::Warning;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
