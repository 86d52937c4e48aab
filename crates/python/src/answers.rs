//! Answers to questions about sensors and their use, by Monte Carlo; scores of claims; words.

mod answer_display;
pub(crate) mod design;
pub(crate) mod distinguish;
mod question;
pub(crate) mod report;
pub(crate) mod sensitivity;
pub(crate) mod words;
