//! Studies as they are written and tabulated: configs, quantities with their units, tables. Without physics.
//!
//! [`config`] turns a TOML text into a validated [`config::Study`] of cells; a [`Quantity`] names what a scene estimates and
//! in which [`Unit`]; a [`Statistic`] is a column over its trials; a [`Label`] says in words what a column holds; a
//! [`Table`] is what results are written as, its numbers by [`number`](mod@number); [`readings`] names the columns of recorded
//! readings; the [`glossary`] says what words mean.

pub mod config;
mod field_error;
pub mod glossary;
pub mod label;
mod limited;
mod map_table;
pub mod number;
mod quantity;
pub mod readings;
mod statistic;
mod table;
mod target;
mod warning;

pub use field_error::FieldError;
pub use label::Label;
pub use limited::{read_all, read_limited};
pub use map_table::MapTable;
pub use number::shortest as number;
pub use quantity::{Quantity, QuantityKind, Unit};
pub use statistic::Statistic;
pub use table::{Rows, Table, csv, push_row};
pub use target::{Bound, Target, TargetError};
pub use warning::Warning;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
