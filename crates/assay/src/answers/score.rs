//! Number of answers that are asked for, and of those that are right.

use serde::Serialize;

/// How much is asked.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Number of seeds with which each scene is asked.
    pub seeds: u64,
    /// Number of pairs of trials against which each probability is held.
    pub pairs: u64,
    /// Only scenes whose names hold these words.
    pub only: &'a str,
}

/// Number of answers that were asked for, and of those that are right.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Score {
    /// `design` or `distinguish`.
    pub command: &'static str,
    /// Name of the scene.
    pub scene: &'static str,
    /// Number of answers.
    pub cases: u64,
    /// Number of right ones.
    pub right: u64,
}
