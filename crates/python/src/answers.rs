//! Answers to questions about sensors and their use, by Monte Carlo; scores of claims; words.

pub(crate) mod design;
pub(crate) mod distinguish;
mod question;
pub(crate) mod report;
mod shown;
pub(crate) mod words;
