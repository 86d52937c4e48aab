//! Reads the configs of studies: converts a TOML text to validated cells. A cell is one combination of the values that
//! the study sweeps.
//!
//! A config is read in four steps, each in its own file:
//!
//! 1. `tree`: the text is parsed to a tree of values. Errors state a path in this tree; `error` finds the position of
//!    this path in the text.
//! 2. `sweep`, `grid`: the cells are formed, that is, all combinations of the values of the `[[sweep]]` axes. The
//!    values of each cell are inserted into the tree.
//! 3. `validate`: each cell's tree is validated by the JSON Schema of the config ([`schema()`]). Only the schema
//!    defines keys, types, kinds and limits. If all swept values are plain (numbers, words or Booleans), only the tree
//!    of the first cell is validated as a whole. The other swept values are then validated one by one. In a study with
//!    many cells, only a sample of the cells is checked (`sample`).
//! 4. serde converts the tree to a [`StudyConfig`], and the few rules that involve several fields are checked.
//!
//! Every failure is a [`ConfigError`] with file, line, column, field and an excerpt.

mod config_builder;
mod config_output;
mod error;
mod field;
mod field_path;
mod field_value;
mod glide;
mod glide_estimator;
mod grid;
pub mod infinite_length;
mod load;
mod marker_sensor;
mod object;
mod plot;
mod press;
mod press_estimator;
mod roll;
mod sample;
mod schema;
mod setting_list;
mod study;
mod sweep;
mod tree;
mod validate;
mod vary;

pub use config_builder::{of_json, with_axes, with_fields};
pub use config_output::to_toml;
pub use error::{ConfigError, FieldError};
pub use field::field;
pub use glide::*;
pub use glide_estimator::*;
pub use load::{Cell, Study, load, parse, plots};
pub use marker_sensor::*;
pub use object::ObjectConfig;
pub use plot::*;
pub use press::*;
pub use press_estimator::*;
pub use roll::*;
pub use schema::schema;
pub use setting_list::*;
pub use study::*;
pub(crate) use tree::suggest;
pub use vary::{Takes, Varied, Vary, VaryError};
