//! Answers to two questions about a study: which values of its fields meet a target, and which of its objects can be
//! distinguished by trials.
//!
//! | question | answer |
//! |---|---|
//! | [`Question`]: which values of one or several fields meet a target? | [`design`] returns a [`Region`] |
//! | how reliably do trials distinguish the swept objects? | [`distinguish`] returns a [`Discrimination`] |
//!
//! Both functions run trials on a [`Runner`](palpate_sweep::Runner), which distributes them among threads. Their
//! answers can be output as sentences, tables, JSON and a figure. If values miss the target because too many trials
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

pub use cell_trials::TrialCounts;
pub use design::design;
pub use discrimination::{Discrimination, Group, Object, Pair};
pub use distinguish::distinguish;
pub use error::AnswerError;
pub use field::Field;
pub use question::{Extreme, Question, Sought};
pub use region::{Best, Region, RegionColumn};
pub use search::{Run, Side};
pub use sensitivity::{FieldEffect, Sensitivity, sensitivity};

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    mod search;
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
