//! Studies as they are written and tabulated: configs, quantities with their units, tables. Without physics.
//!
//! [`config`] turns a TOML text into a validated [`config::Study`] of cells; a [`Quantity`] names what is tabulated,
//! in which [`Unit`]; a [`Table`] is what results are written as.

pub mod config;
mod quantity;
mod table;

pub use quantity::{Quantity, QuantityKind, Unit};
pub use table::{Table, number};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
