//! Answers questions about sensors and their use, computed by Monte Carlo simulation. Also scores the papers' claims
//! and explains words.

mod answer_display;
pub(crate) mod design;
pub(crate) mod distinguish;
mod question;
pub(crate) mod report;
pub(crate) mod sensitivity;
pub(crate) mod words;
