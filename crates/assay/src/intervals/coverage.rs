//! Counts warnings, errors and correct intervals over the trials of a scene, and computes the score of a family of
//! scenes from these counts.

use std::collections::BTreeMap;

use palpate_statistics::HALF_WIDTHS;

use super::random_scene::RandomScene;

/// Name of the error which reports that the assumed soft body cannot explain the readings of a press. This error counts
/// as a warning.
const REJECTED: &str = "other-body";

/// For each name of a warning or error: the number of trials of a scene with this warning or error.
type NameCounts = BTreeMap<&'static str, f64>;

/// Counts over the trials of a scene: warnings, errors, and intervals that contain the true value.
#[derive(Clone, Debug, Default)]
pub(super) struct SceneCoverage {
    trials: f64,
    estimates: f64,
    warned: f64,
    warnings: NameCounts,
    failures: NameCounts,
    /// For each counted quantity: the number of estimates, and the numbers of the 50, 80 and 95 % intervals that
    /// contain the true value.
    quantities: Vec<(f64, [f64; 3])>,
}

impl SceneCoverage {
    pub(super) fn add(&mut self, scene: &RandomScene, trial: u64) {
        let mut hits: Vec<(usize, [bool; 3])> = Vec::new();
        let warnings = scene.trial(trial, &mut |quantity, outcome| {
            let error = (outcome.estimate - outcome.truth).abs();
            let by_std = outcome
                .std
                .map(|std| HALF_WIDTHS.map(|width| error <= width * std));
            let holds = outcome.interval_holds.or(by_std).unwrap_or_default();
            let place = scene.quantities.iter().position(|one| *one == quantity);
            hits.extend(place.map(|place| (place, holds)));
        });
        self.quantities
            .resize(scene.quantities.len(), (0.0, [0.0; 3]));
        self.count(warnings, &hits);
    }

    /// Adds a trial to the counts: its warnings or its error, and for each quantity whether the intervals contain the
    /// true value.
    fn count(
        &mut self,
        warnings: Result<Vec<&'static str>, &'static str>,
        hits: &[(usize, [bool; 3])],
    ) {
        self.trials += 1.0;
        match warnings {
            Ok(warnings) => {
                self.estimates += 1.0;
                self.warned += f64::from(u8::from(!warnings.is_empty()));
                for name in warnings {
                    *self.warnings.entry(name).or_default() += 1.0;
                }
                for (place, holds) in hits {
                    let (count, sums) = &mut self.quantities[*place];
                    *count += 1.0;
                    for (sum, holds) in sums.iter_mut().zip(holds) {
                        *sum += f64::from(u8::from(*holds));
                    }
                }
            }
            Err(name) => {
                self.warned += f64::from(u8::from(name == REJECTED));
                *self.failures.entry(name).or_default() += 1.0;
            }
        }
    }

    /// Shares of the trials whose 50, 80 and 95 % intervals of one quantity contain the true value. A trial without an
    /// estimate counts as if its intervals missed the true value.
    fn shares(&self, quantity: usize) -> [f64; 3] {
        match self.quantities.get(quantity) {
            Some((count, sums)) if *count > 0.0 => {
                sums.map(|sum| sum / count * self.estimates / self.trials)
            }
            _ => [0.0; 3],
        }
    }
}

/// Coverage and warnings of a family of scenes, summarised over all its scenes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Score {
    pub(super) scenes: usize,
    pub(super) trials: f64,
    pub(super) failed: f64,
    pub(super) failures: String,
    /// Coverage of the 50, 80 and 95 % intervals of one quantity: the quantity whose 95 % intervals have the lowest
    /// coverage.
    pub(super) coverage: [f64; 3],
    /// Lowest coverage of 95 % intervals in a single scene, for the same quantity as in `coverage`.
    pub(super) lowest: f64,
    pub(super) warned: f64,
    pub(super) warnings: String,
}

impl Score {
    pub(super) fn new(scenes: &[SceneCoverage]) -> Self {
        let sum = |part: fn(&SceneCoverage) -> f64| scenes.iter().map(part).sum::<f64>();
        let (trials, estimates) = (sum(|one| one.trials), sum(|one| one.estimates));
        let names = |part: fn(&SceneCoverage) -> &NameCounts| {
            let mut total = NameCounts::new();
            for (name, count) in scenes.iter().flat_map(part) {
                *total.entry(name).or_default() += count;
            }
            let shares = total.iter();
            let shares = shares.map(|(name, count)| format!("{name} {}", rounded(count / trials)));
            shares.collect::<Vec<_>>().join(" ")
        };
        let quantities = scenes.iter().map(|one| one.quantities.len()).max();
        let coverages = (0..quantities.unwrap_or(0)).map(|quantity| {
            let shares: Vec<[f64; 3]> = scenes.iter().map(|one| one.shares(quantity)).collect();
            let mean = |width: usize| {
                shares.iter().map(|one| one[width]).sum::<f64>() / shares.len() as f64
            };
            let lowest = shares.iter().map(|one| one[2]).fold(1.0, f64::min);
            ([0, 1, 2].map(mean), lowest)
        });
        let lowest = coverages.min_by(|one, other| one.0[2].total_cmp(&other.0[2]));
        let (coverage, lowest) = lowest.unwrap_or_default();
        let rejected = |one: &SceneCoverage| one.failures.get(REJECTED).copied().unwrap_or(0.0);
        let rejected: f64 = scenes.iter().map(rejected).sum();
        Self {
            scenes: scenes.len(),
            trials: trials / scenes.len() as f64,
            failed: rounded(1.0 - estimates / trials),
            failures: names(|one| &one.failures),
            coverage: coverage.map(rounded),
            lowest: rounded(lowest),
            warned: rounded(sum(|one| one.warned) / (estimates + rejected).max(1.0)),
            warnings: names(|one| &one.warnings),
        }
    }

    pub(super) fn columns(&self) -> [(&'static str, String); 10] {
        let [half, most, all] = self.coverage;
        [
            ("scenes", self.scenes.to_string()),
            ("trials", self.trials.to_string()),
            ("failed", self.failed.to_string()),
            ("failures", self.failures.clone()),
            ("coverage50", half.to_string()),
            ("coverage80", most.to_string()),
            ("coverage95", all.to_string()),
            ("lowest", self.lowest.to_string()),
            ("warned", self.warned.to_string()),
            ("warnings", self.warnings.clone()),
        ]
    }
}

fn rounded(share: f64) -> f64 {
    (1e3 * share).round() / 1e3
}
