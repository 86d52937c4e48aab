//! Number of trials, and number of failed trials.

use std::collections::BTreeMap;

use palpate_sweep::{CellStatistics, TrialMeans};

use crate::words::percent;

/// Number of trials of a cell, and number of its failed trials.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrialCounts {
    /// Number of trials of the cell; 0 if no trial was run because the readings do not determine an estimate.
    pub trials: u64,
    /// Number of failed trials of the cell.
    pub failed: u64,
    /// The most frequent kind of failure, and the number of trials that failed in this way.
    pub main_failure: Option<(&'static str, u64)>,
}

impl TrialCounts {
    pub(crate) fn not_estimable(kind: &'static str) -> Self {
        Self {
            main_failure: Some((kind, 0)),
            ..Self::default()
        }
    }

    pub(crate) fn failure_rate(&self) -> f64 {
        match self.trials {
            0 => 1.0,
            trials => self.failed as f64 / trials as f64,
        }
    }

    /// Text that states the share of failed trials and the share of the most frequent kind of failure. `trials` is the
    /// word for trials, and `at` describes the cell.
    pub(crate) fn failures_in_words(&self, trials: &str, at: &str) -> String {
        let kind = |share: String| match self.main_failure {
            Some((kind, _)) => format!(" (`{kind}`{share})"),
            None => String::new(),
        };
        if self.trials == 0 {
            return format!(
                "no estimate is possible from the readings at {at}{}",
                kind(String::new())
            );
        }
        let main = self.main_failure.map_or(0, |(_, count)| count);
        let share = match main == self.failed {
            true => String::new(),
            false => format!(" {} %", percent(main as f64 / self.trials as f64)),
        };
        let failing = percent(self.failure_rate());
        format!("{failing} % of {trials} fail at {at}{}", kind(share))
    }
}

impl From<&CellStatistics> for TrialCounts {
    fn from(all: &CellStatistics) -> Self {
        let kinds = all.failures.iter().rev();
        let main = kinds.max_by_key(|failure| failure.count);
        Self {
            trials: all.trials,
            failed: all.failed(),
            main_failure: main.map(|main| (main.kind, main.count)),
        }
    }
}

impl From<&[TrialMeans]> for TrialCounts {
    fn from(trials: &[TrialMeans]) -> Self {
        let mut kinds: BTreeMap<&str, u64> = BTreeMap::new();
        for kind in trials.iter().filter_map(|trial| trial.err()) {
            *kinds.entry(kind).or_default() += 1;
        }
        Self {
            trials: trials.len() as u64,
            failed: kinds.values().sum(),
            main_failure: kinds.into_iter().rev().max_by_key(|(_, count)| *count),
        }
    }
}
