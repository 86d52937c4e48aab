//! How often estimates are doubted, where their intervals hold and where they do not.

use std::collections::BTreeMap;
use std::fmt;

use super::sums::HOLDS;

/// Least coverage of estimates that are not to be doubted, largest share of these that are, and least share of those that are
/// to be.
const COVERED: f64 = 0.92;
const UNDOUBTED: f64 = 0.05;
const DOUBTED: f64 = 0.9;

/// Doubts of the estimates of a scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Doubts {
    doubted: f64,
    names: BTreeMap<&'static str, f64>,
}

impl Doubts {
    /// Counts an estimate with doubts of these names.
    pub(super) fn add(&mut self, names: impl Iterator<Item = &'static str>) {
        let mut is_doubted = false;
        for name in names {
            is_doubted = true;
            *self.names.entry(name).or_default() += 1.0;
        }
        self.doubted += f64::from(u8::from(is_doubted));
    }

    /// Number of estimates that are doubted.
    pub(super) const fn doubted(&self) -> f64 {
        self.doubted
    }
}

/// Coverage of intervals of 95 % in a scene, and the share of its estimates that are doubted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scene {
    pub(super) coverage: f64,
    pub(super) doubted: f64,
}

/// Doubts where intervals hold and where they do not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Number of scenes whose intervals hold in less than 85 %, and the share of doubted estimates in these.
    pub short: (usize, f64),
    /// Number of scenes whose intervals hold in at least 92 %, and the share of doubted estimates in these.
    pub covered: (usize, f64),
}

impl Shares {
    pub(super) fn of(scenes: &[Scene]) -> Self {
        let among = |is: &dyn Fn(f64) -> bool| {
            let those = scenes.iter().filter(|scene| is(scene.coverage));
            let (count, sum) = those.fold((0, 0.0), |(count, sum), scene| {
                (count + 1, sum + scene.doubted)
            });
            (count, sum / count as f64)
        };
        Self {
            short: among(&|coverage| coverage < HOLDS),
            covered: among(&|coverage| coverage >= COVERED),
        }
    }

    /// Whether what is wrong is doubted, and what holds is not.
    pub(super) fn hold(&self) -> bool {
        self.short_is_doubted() && self.covered_is_not()
    }

    fn short_is_doubted(&self) -> bool {
        self.short.0 == 0 || self.short.1 >= DOUBTED
    }

    /// Whether estimates that hold are hardly ever doubted.
    pub(super) fn covered_is_not(&self) -> bool {
        self.covered.0 == 0 || self.covered.1 <= UNDOUBTED
    }
}

impl fmt::Display for Shares {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [(short, of_short), (covered, of_covered)] = [self.short, self.covered];
        write!(
            f,
            "doubted {:.1} % in {short} scenes short, {:.1} % in {covered} covered",
            100.0 * of_short,
            100.0 * of_covered,
        )
    }
}

/// Names of doubts with their shares of this many estimates.
pub(super) fn words<'a>(scenes: impl Iterator<Item = &'a Doubts>, estimates: f64) -> String {
    let mut all: BTreeMap<&str, f64> = BTreeMap::new();
    for (name, count) in scenes.flat_map(|one| &one.names) {
        *all.entry(name).or_default() += count;
    }
    let words = all
        .iter()
        .map(|(name, count)| format!("{name} {:.3}", count / estimates));
    words.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_told_apart_by_their_coverage() {
        let scene = |coverage, doubted| Scene { coverage, doubted };
        let shares = Shares::of(&[
            scene(0.5, 1.0),
            scene(0.8, 0.8),
            scene(0.9, 0.4),
            scene(0.95, 0.1),
        ]);
        assert_eq!((shares.short, shares.covered), ((2, 0.9), (1, 0.1)));
        assert!(!shares.hold() && !shares.covered_is_not());
        let mut doubts = Doubts::default();
        doubts.add(["a", "b"].into_iter());
        doubts.add(std::iter::empty());
        assert_eq!(doubts.doubted(), 1.0);
        assert_eq!(words([doubts].iter(), 2.0), "a 0.500 b 0.500");
    }
}
