//! Answers to questions about sensors and their use, found by Monte Carlo simulation. Also the scores of the papers'
//! claims, and the meanings of words.

mod answer_display;
pub(crate) mod design;
pub(crate) mod distinguish;
mod question;
pub(crate) mod report;
pub(crate) mod sensitivity;
pub(crate) mod words;
