//! Coverage of intervals: sums over the trials of a scene, and the scores of families of presses, rolls and glides.

use palpate_statistics::HALF_WIDTHS;
use serde::Serialize;

use super::false_alarms::{NameCounts, SceneWarnings, WarningShares};

/// Smallest coverage of 95 % intervals at which the intervals of a scene count as correct.
pub(super) const MIN_COVERAGE: f64 = 0.85;

/// Sums over the places and trials of one scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Sums {
    /// Number of curvatures to estimate.
    pub(super) attempts: f64,
    /// Number of estimates with a standard deviation.
    pub(super) estimates: f64,
    /// Numbers of intervals of 50, 80 and 95 % that contain the true value.
    pub(super) hits: [f64; 3],
    pub(super) error: f64,
    pub(super) square_error: f64,
    pub(super) square_std: f64,
    pub(super) std: f64,
}

/// Whether intervals of these half-widths, in standard deviations, contain the true value.
pub(super) fn contain_truth(error: f64, std: f64, half_widths: [f64; 3]) -> [bool; 3] {
    half_widths.map(|width| error.abs() <= width * std)
}

impl Sums {
    pub(super) fn new(attempts: f64) -> Self {
        Self {
            attempts,
            ..Self::default()
        }
    }

    /// Adds an estimate with normal errors.
    pub(super) fn add(&mut self, error: f64, std: f64) {
        self.add_hits(error, std, contain_truth(error, std, HALF_WIDTHS));
    }

    pub(super) fn add_hits(&mut self, error: f64, std: f64, hits: [bool; 3]) {
        self.estimates += 1.0;
        for (sum, hit) in self.hits.iter_mut().zip(hits) {
            *sum += f64::from(u8::from(hit));
        }
        self.error += error;
        self.square_error += error * error;
        self.square_std += std * std;
        self.std += std;
    }

    /// Coverage of intervals of 50 (0), 80 (1) or 95 % (2). A trial without an estimate counts as a miss.
    pub(super) fn coverage(&self, width: usize) -> f64 {
        self.hits[width] / self.attempts
    }

    pub(super) fn std_per_rms(&self) -> f64 {
        (self.square_std / self.square_error).sqrt()
    }

    /// Root mean square of the errors.
    pub(super) fn rms(&self) -> f64 {
        (self.square_error / self.estimates).sqrt()
    }

    /// Mean error over the errors' standard deviation.
    pub(super) fn mean_per_scatter(&self) -> f64 {
        let mean = self.error / self.estimates;
        let variance = (self.square_error - self.estimates * mean * mean) / (self.estimates - 1.0);
        mean / variance.sqrt()
    }
}

/// Coverage over several scenes.
pub(super) struct Coverage {
    /// Share of trials without an estimate.
    pub(super) failed: f64,
    /// Coverage of intervals of 50, 80 and 95 %.
    pub(super) shares: [f64; 3],
    /// Share of scenes with a 95 % coverage of at least 85 %.
    pub(super) scenes_above_85: f64,
    /// 95 % coverage of the scene with the lowest one.
    pub(super) lowest: f64,
}

impl Coverage {
    pub(super) fn new(scenes: &[&Sums]) -> Self {
        let mean = |part: &dyn Fn(&Sums) -> f64| {
            scenes.iter().map(|scene| part(scene)).sum::<f64>() / scenes.len() as f64
        };
        Self {
            failed: mean(&|scene| 1.0 - scene.estimates / scene.attempts),
            shares: [0, 1, 2].map(|width| mean(&|scene| scene.coverage(width))),
            scenes_above_85: mean(&|scene| f64::from(u8::from(scene.coverage(2) >= MIN_COVERAGE))),
            lowest: scenes
                .iter()
                .map(|scene| scene.coverage(2))
                .fold(1.0, f64::min),
        }
    }
}

/// Counts over the trials of one scene.
#[derive(Debug, Default)]
pub(super) struct Tally {
    pub(super) sums: Sums,
    pub(super) failures: NameCounts,
    pub(super) warnings: NameCounts,
    pub(super) estimates: f64,
    /// Number of estimates with a p-value, and of those with one below 0.05.
    pub(super) p_values: [f64; 2],
    /// Share of trials in which the best test detects the flaw of the readings; NaN without a flaw.
    pub(super) detectable: f64,
    /// Number of estimates with a warning, and of those whose warnings all name the true flaw.
    pub(super) warned: f64,
    pub(super) rightly_warned: f64,
    /// Number of trials in which the estimator rejected its model. They count as estimates with a warning.
    pub(super) rejected: f64,
}

impl Tally {
    /// Counts an estimate with the p-value of its fit, if it has one, and the names of its warnings.
    pub(super) fn add_estimate(
        &mut self,
        p_value: Option<f64>,
        warnings: impl Iterator<Item = &'static str>,
    ) {
        self.estimates += 1.0;
        if let Some(p_value) = p_value {
            self.p_values[0] += 1.0;
            self.p_values[1] += f64::from(u8::from(p_value < 0.05));
        }
        self.warned += f64::from(u8::from(self.warnings.add(warnings)));
    }

    /// Coverage of 95 % intervals among the estimates, and the share of them with a warning. If the intervals are correct
    /// all the same, a warning that names the true flaw does not count.
    pub(super) fn scene(&self) -> SceneWarnings {
        let coverage = self.sums.hits[2] / (self.sums.estimates + self.rejected);
        let right = match coverage >= MIN_COVERAGE {
            true => self.rightly_warned,
            false => 0.0,
        };
        SceneWarnings {
            coverage,
            warned: (self.warned - right + self.rejected) / (self.estimates + self.rejected),
        }
    }
}

/// Row of the tables of presses, rolls and glides: coverage and warnings of a family, over all its scenes. A harness leaves
/// out the columns that are `None`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Score {
    /// The family.
    pub family: String,
    /// Number of scenes.
    pub scenes: usize,
    /// Share of trials whose readings alone show a contact; false alarms if nothing touches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seen: Option<f64>,
    /// Share of trials in which the best test with 5 % false alarms detects the contact without a known place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detectable: Option<f64>,
    /// Share of trials without an interval. Each counts as a miss.
    pub failed: f64,
    /// Names of their errors.
    pub failures: String,
    /// Share of 50 % intervals that contain the true value.
    pub coverage50: f64,
    /// Share of 80 % intervals that contain the true value.
    pub coverage80: f64,
    /// Share of 95 % intervals that contain the true value.
    pub coverage95: f64,
    /// Share of scenes with a 95 % coverage of at least 85 %.
    pub scenes_above_85: f64,
    /// 95 % coverage of the scene with the lowest one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lowest: Option<f64>,
    /// Width of 95 % intervals, in curvatures of the sensor or probe: of presses the median of the closed ones, of rolls
    /// the mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Share of intervals with two ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed: Option<f64>,
    /// Share of intervals with one end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub one_sided: Option<f64>,
    /// Share of intervals without an end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open: Option<f64>,
    /// Share of trials with a p-value below 0.05; NaN if the noise is not stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub below_5_percent: Option<f64>,
    /// Number of scenes with a 95 % coverage below 85 %.
    pub scenes_short: usize,
    /// Share of estimates with a warning in these scenes.
    pub doubted_where_short: f64,
    /// Number of scenes with a 95 % coverage of at least 92 %.
    pub scenes_covered: usize,
    /// Share of estimates with a warning in these scenes.
    pub doubted_where_covered: f64,
    /// Mean share of trials in which the best test with 5 % false alarms detects the flaw, over the scenes with a coverage
    /// below 85 %; NaN without a flaw.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tellable_where_short: Option<f64>,
    /// Share of estimates that leave out markers as outliers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<f64>,
    /// Names of the warnings, with the share of estimates that have each.
    pub doubts: String,
    /// Whether the row meets its limits; `None` if it has none.
    pub is_within_limits: Option<bool>,
}

impl Score {
    /// The columns that all harnesses have.
    pub(super) fn new(family: String, scenes: &[&Tally]) -> (Self, WarningShares) {
        let sums: Vec<&Sums> = scenes.iter().map(|scene| &scene.sums).collect();
        let coverage = Coverage::new(&sums);
        let warnings: Vec<SceneWarnings> = scenes.iter().map(|scene| scene.scene()).collect();
        let shares = WarningShares::new(&warnings);
        let estimates = scenes.iter().map(|scene| scene.estimates).sum();
        let score = Self {
            family,
            scenes: scenes.len(),
            failed: coverage.failed,
            failures: NameCounts::total(scenes.iter().map(|scene| &scene.failures)).names(),
            coverage50: coverage.shares[0],
            coverage80: coverage.shares[1],
            coverage95: coverage.shares[2],
            scenes_above_85: coverage.scenes_above_85,
            lowest: Some(coverage.lowest),
            scenes_short: shares.short.0,
            doubted_where_short: shares.short.1,
            scenes_covered: shares.covered.0,
            doubted_where_covered: shares.covered.1,
            doubts: NameCounts::total(scenes.iter().map(|scene| &scene.warnings)).shares(estimates),
            ..Self::default()
        };
        (score, shares)
    }
}

/// Share of p-values below 0.05.
pub(super) fn below_5_percent(scenes: &[Tally]) -> f64 {
    let count = |place: usize| {
        scenes
            .iter()
            .map(|scene| scene.p_values[place])
            .sum::<f64>()
    };
    count(1) / count(0)
}

/// Mean share of detectable flaws over the scenes with a coverage below 85 %.
pub(super) fn detectable_where_short(scenes: &[&Tally]) -> f64 {
    let short = scenes
        .iter()
        .filter(|scene| scene.scene().coverage < MIN_COVERAGE);
    let shares: Vec<f64> = short.map(|scene| scene.detectable).collect();
    shares.iter().sum::<f64>() / shares.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_error_counts_in_the_scatter() {
        let mut sums = Sums::default();
        for error in [1.0, 2.0, 3.0] {
            sums.add(error, 1.0);
        }
        // Their standard deviation is 1.
        assert!((sums.mean_per_scatter() - 2.0).abs() < 1e-12);
        assert!((sums.rms() - (14.0_f64 / 3.0).sqrt()).abs() < 1e-12);
    }
}
