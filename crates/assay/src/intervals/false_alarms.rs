//! Warnings of estimates: how often they are raised on scenes whose intervals are wrong, and on scenes whose intervals are
//! correct.

use std::collections::BTreeMap;

use super::coverage::MIN_COVERAGE;

/// Coverage of 95 % intervals from which on a warning is a false alarm.
const CORRECT_COVERAGE: f64 = 0.92;
const MAX_FALSE_ALARMS: f64 = 0.05;
/// Smallest share of estimates with a warning on scenes whose intervals are wrong.
const MIN_DETECTED: f64 = 0.9;

/// Numbers of estimates, by the names of their warnings or errors.
#[derive(Clone, Debug, Default)]
pub(super) struct NameCounts(BTreeMap<&'static str, f64>);

impl NameCounts {
    /// Counts the names of one estimate, and returns whether there are any.
    pub(super) fn add(&mut self, names: impl IntoIterator<Item = &'static str>) -> bool {
        let mut any = false;
        for name in names {
            any = true;
            *self.0.entry(name).or_default() += 1.0;
        }
        any
    }

    pub(super) fn total<'a>(scenes: impl Iterator<Item = &'a Self>) -> Self {
        let mut total = Self::default();
        for (name, count) in scenes.flat_map(|scene| &scene.0) {
            *total.0.entry(name).or_default() += count;
        }
        total
    }

    /// All names, in alphabetical order.
    pub(super) fn names(&self) -> String {
        self.0.keys().copied().collect::<Vec<_>>().join(" ")
    }

    /// All names, each with its share of this many estimates.
    pub(super) fn shares(&self, estimates: f64) -> String {
        let share = |(name, count): (&&str, &f64)| format!("{name} {:.3}", count / estimates);
        self.0.iter().map(share).collect::<Vec<_>>().join(" ")
    }
}

/// Coverage of 95 % intervals in a scene, and the share of its estimates with a warning.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneWarnings {
    pub(super) coverage: f64,
    pub(super) warned: f64,
}

/// Shares of estimates with a warning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WarningShares {
    /// Number of scenes with a 95 % coverage below 85 %, and the share of their estimates with a warning.
    pub(super) short: (usize, f64),
    /// Number of scenes with a 95 % coverage of at least 92 %, and the share of their estimates with a warning.
    pub(super) covered: (usize, f64),
}

impl WarningShares {
    pub(super) fn new(scenes: &[SceneWarnings]) -> Self {
        let among = |is: &dyn Fn(f64) -> bool| {
            let those = scenes.iter().filter(|scene| is(scene.coverage));
            let (count, sum) = those.fold((0, 0.0), |(count, sum), scene| {
                (count + 1, sum + scene.warned)
            });
            (count, sum / count as f64)
        };
        Self {
            short: among(&|coverage| coverage < MIN_COVERAGE),
            covered: among(&|coverage| coverage >= CORRECT_COVERAGE),
        }
    }

    /// Whether wrong intervals come with a warning, and correct ones without.
    pub(super) fn meet_limits(&self) -> bool {
        (self.short.0 == 0 || self.short.1 >= MIN_DETECTED) && self.false_alarms_are_rare()
    }

    pub(super) fn false_alarms_are_rare(&self) -> bool {
        self.covered.0 == 0 || self.covered.1 <= MAX_FALSE_ALARMS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_divided_by_their_coverage() {
        let scene = |coverage, warned| SceneWarnings { coverage, warned };
        let shares = WarningShares::new(&[
            scene(0.5, 1.0),
            scene(0.8, 0.8),
            scene(0.9, 0.4),
            scene(0.95, 0.1),
        ]);
        assert_eq!((shares.short, shares.covered), ((2, 0.9), (1, 0.1)));
        assert!(!shares.meet_limits() && !shares.false_alarms_are_rare());
        let mut counts = NameCounts::default();
        assert!(counts.add(["a", "b"]) && !counts.add([]));
        assert_eq!(counts.shares(2.0), "a 0.500 b 0.500");
    }
}
