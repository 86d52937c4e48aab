//! Doubts about estimates, held against how often their intervals hold.

use std::collections::BTreeMap;
use std::fmt;

use super::sums::HOLDS;

/// Least coverage of estimates that are not to be doubted, largest share of these that are, and least share of those that
/// are to be.
const COVERED: f64 = 0.92;
const UNDOUBTED: f64 = 0.05;
const DOUBTED: f64 = 0.9;

/// Doubts in scenes whose intervals hold, and in those where they do not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubted {
    /// Number of scenes whose intervals of 95 % hold in less than 85 % of the estimates.
    pub scenes_short: usize,
    /// Share of doubted estimates in these.
    pub where_short: f64,
    /// Number of scenes whose intervals of 95 % hold in at least 92 % of the estimates.
    pub scenes_covered: usize,
    /// Share of doubted estimates in these.
    pub where_covered: f64,
}

impl Doubted {
    /// The doubts in scenes with these coverages and shares of doubted estimates.
    pub(super) fn of(scenes: impl Iterator<Item = (f64, f64)> + Clone) -> Self {
        let those = |is: fn(f64) -> bool| {
            let doubted = scenes.clone().filter(|(coverage, _)| is(*coverage));
            let doubted: Vec<f64> = doubted.map(|(_, doubted)| doubted).collect();
            let mean = doubted.iter().sum::<f64>() / doubted.len() as f64;
            (doubted.len(), mean)
        };
        let (scenes_short, where_short) = those(|coverage| coverage < HOLDS);
        let (scenes_covered, where_covered) = those(|coverage| coverage >= COVERED);
        Self {
            scenes_short,
            where_short,
            scenes_covered,
            where_covered,
        }
    }

    /// Whether wrong intervals are doubted and others are not.
    pub(super) fn is_within_limits(&self) -> bool {
        (self.scenes_short == 0 || self.where_short >= DOUBTED)
            && (self.scenes_covered == 0 || self.where_covered <= UNDOUBTED)
    }
}

impl fmt::Display for Doubted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            scenes_short,
            where_short,
            scenes_covered,
            where_covered,
        } = self;
        write!(
            f,
            "doubted {:.1} % in {scenes_short} scenes short, {:.1} % in {scenes_covered} covered",
            100.0 * where_short,
            100.0 * where_covered,
        )
    }
}

/// Names of doubts with their shares of all estimates.
pub(super) fn shares(counts: &BTreeMap<&str, f64>, estimates: f64) -> String {
    let words = counts
        .iter()
        .map(|(name, count)| format!("{name} {:.3}", count / estimates));
    words.collect::<Vec<_>>().join(" ")
}
