//! Answers to three questions about a study: which values of its fields meet a target, which of its objects can be
//! distinguished by trials, and which field changes the error most.
//!
//! | question | answer |
//! |---|---|
//! | [`Question`]: which values of one or several fields meet a target? | [`design`] returns a [`Region`] |
//! | how reliably do trials distinguish the swept objects? | [`distinguish`] returns a [`Discrimination`] |
//! | which field changes the error most? | [`sensitivity()`] returns a [`Sensitivity`] |
//!
//! The functions run trials on a [`Runner`](palpate_sweep::Runner), which distributes them among threads. Their
//! results are [`Answer`]s, with sentences, tables, JSON and a figure. If values miss the target because too many trials
//! fail, the answer names the most frequent kind of failure.

mod cell_trials;
mod design;
mod discrimination;
mod distinguish;
mod error;
mod field;
mod grid;
mod question;
mod region;
mod region_figure;
mod region_table;
mod region_text;
mod search;
mod sensitivity;
mod target_score;
mod words;

use palpate_report::{Figure, ReportError};
use palpate_study::Table;
use palpate_study::config::Study;
use serde_json::Value;

pub use cell_trials::TrialCounts;
pub use design::design;
pub use discrimination::{Discrimination, Group, Object, Pair};
pub use distinguish::distinguish;
pub use error::AnswerError;
pub use field::Field;
pub use question::{Extreme, Question, Sought};
pub use region::{Best, Region, RegionColumn};
pub use sensitivity::{FieldEffect, Sensitivity, sensitivity};

/// The result of [`design`], [`distinguish`] or [`sensitivity`], in the forms in which it can be output.
pub trait Answer {
    /// The answer in lines of text.
    fn lines(&self) -> Vec<String>;

    /// Table of the results.
    fn table(&self) -> Table;

    /// The answer as JSON. `study` is the study of the question.
    fn to_json(&self, study: &Study) -> Value;

    /// Figure of the results. `name` is the name of the figure's files.
    ///
    /// # Errors
    /// [`ReportError`] if the figure cannot be drawn.
    fn figure(&self, name: &str, title: &str) -> Result<Figure, ReportError>;
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    mod search;
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
