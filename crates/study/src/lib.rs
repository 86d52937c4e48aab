//! Studies as they are written and tabulated: configs, quantities with their units, tables. Without physics.
//!
//! [`config`] turns a TOML text into a validated [`config::Study`] of cells; a [`Quantity`] names what a scene estimates and
//! in which [`Unit`]; a [`Table`] is what results are written as.

pub mod config;
mod quantity;
mod table;

pub use quantity::{Quantity, Unit};
pub use table::{Table, number};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
