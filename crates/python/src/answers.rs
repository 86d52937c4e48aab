//! Answers to questions about sensors and their use, by Monte Carlo.

pub(crate) mod design;
pub(crate) mod distinguish;
