//! How often intervals of rolls hold, how wide they are, and how often estimates are doubted.

use std::collections::BTreeSet;
use std::fmt;

use anyhow::Result;
use palpate_ep1::{LeastSquares, ReadingNoise};
use serde::Serialize;

use super::super::doubted::{Doubts, Scene, Shares, words};
use super::super::sums::{HOLDS, Sums, within_widths};
use super::case::{Case, Family};
use super::flaw::{Flaw, RADIUS};

/// How often the intervals of a family hold, over all its scenes: those of the normal distribution where noise is told, of
/// Student's where it is found from the residuals.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// The family.
    pub family: String,
    /// Number of scenes.
    pub scenes: usize,
    /// Share of trials that gave no interval; a miss of each.
    pub failed: f64,
    /// Names of what went wrong in them.
    pub failures: String,
    /// Share of intervals of 50 % that hold the truth, of both normal curvatures.
    pub coverage50: f64,
    /// Share of intervals of 80 % that hold the truth.
    pub coverage80: f64,
    /// Share of intervals of 95 % that hold the truth.
    pub coverage95: f64,
    /// Share of scenes in which those of 95 % hold in at least 85 %.
    pub scenes_above_85: f64,
    /// Coverage of intervals of 95 % in the scene where it is lowest.
    pub lowest: f64,
    /// Mean width of intervals of 95 %, in curvatures of the probe; all are closed.
    pub width: f64,
    /// Share of trials whose p-value is below 0.05; `None` where no noise is told.
    pub below_5_percent: Option<f64>,
    /// Number of scenes whose intervals of 95 % hold in less than 85 %.
    pub scenes_short: usize,
    /// Share of doubted estimates in these.
    pub doubted_where_short: f64,
    /// Number of scenes whose intervals of 95 % hold in at least 92 %.
    pub scenes_covered: usize,
    /// Share of doubted estimates in these.
    pub doubted_where_covered: f64,
    /// Names of the doubts, with the share of estimates that have each.
    pub doubts: String,
    /// Whether the doubts are within the limits; `None` of what no reading tells from another curvature.
    pub is_within_limits: Option<bool>,
}

/// Sums over the trials of a scene.
#[derive(Default)]
pub(super) struct Tally {
    sums: Sums,
    failures: BTreeSet<&'static str>,
    doubts: Doubts,
    estimates: f64,
    goodness: f64,
    unlikely: f64,
}

/// The trials of a scene.
///
/// # Errors
/// None that a family makes.
pub(super) fn tally(case: &Case, trials: u64) -> Result<Tally> {
    let mut tally = Tally::default();
    tally.sums.asked = 2.0 * trials as f64;
    for trial in 0..trials {
        let readings = case.readings(trial)?;
        let (fit, mut estimate) = match LeastSquares::fitted(case.radius, case.told, &readings) {
            Ok(fitted) => fitted,
            Err(error) => {
                tally.failures.insert(error.name());
                continue;
            }
        };
        let agreement = fit.agreement(&estimate, &readings);
        if let Some(goodness) = agreement.goodness {
            tally.goodness += 1.0;
            tally.unlikely += f64::from(u8::from(goodness.p_value < 0.05));
        } else {
            // As `estimate roll` does where no noise is stated.
            let found = ReadingNoise {
                shift_std: estimate.residual(&readings).0,
                ..case.told
            };
            estimate = LeastSquares::of(case.radius, found, &readings)?;
        }
        tally.estimates += 1.0;
        tally
            .doubts
            .add(agreement.doubts.iter().map(|doubt| doubt.name()));
        let both = [
            (estimate.normal_curvature_u, case.truth.k_uu),
            (estimate.normal_curvature_v, case.truth.k_vv),
        ];
        for (measured, truth) in both {
            let (error, std) = (measured.value - truth, measured.std.unwrap_or(0.0));
            let holds = within_widths(error, std, case.half_widths);
            tally.sums.add(error, std, holds);
        }
    }
    Ok(tally)
}

impl Score {
    /// The score of a family from its scenes.
    pub(super) fn of(family: &Family, scenes: &[Tally]) -> Self {
        let sum = |part: &dyn Fn(&Tally) -> f64| scenes.iter().map(part).sum::<f64>();
        let mean = |part: &dyn Fn(&Tally) -> f64| sum(part) / scenes.len() as f64;
        let failures: BTreeSet<&str> = scenes.iter().flat_map(|one| one.failures.clone()).collect();
        let lowest = scenes.iter().map(|one| one.sums.coverage(2));
        let told: Vec<Scene> = scenes
            .iter()
            .filter(|one| one.estimates > 0.0)
            .map(|one| Scene {
                coverage: one.sums.within[2] / one.sums.stated,
                doubted: one.doubts.doubted() / one.estimates,
            })
            .collect();
        let shares = Shares::of(&told);
        let goodness = sum(&|one| one.goodness);
        Self {
            family: family.name(),
            scenes: scenes.len(),
            failed: mean(&|one| 1.0 - one.sums.stated / one.sums.asked),
            failures: failures.into_iter().collect::<Vec<_>>().join(" "),
            coverage50: mean(&|one| one.sums.coverage(0)),
            coverage80: mean(&|one| one.sums.coverage(1)),
            coverage95: mean(&|one| one.sums.coverage(2)),
            scenes_above_85: mean(&|one| f64::from(u8::from(one.sums.coverage(2) >= HOLDS))),
            lowest: lowest.fold(1.0, f64::min),
            width: 2.0 * family.half_widths()[2] * RADIUS * sum(&|one| one.sums.std)
                / sum(&|one| one.sums.stated),
            below_5_percent: (goodness > 0.0).then(|| sum(&|one| one.unlikely) / goodness),
            scenes_short: shares.short.0,
            doubted_where_short: shares.short.1,
            scenes_covered: shares.covered.0,
            doubted_where_covered: shares.covered.1,
            doubts: words(
                scenes.iter().map(|one| &one.doubts),
                sum(&|one| one.estimates),
            ),
            is_within_limits: match family.flaw {
                Flaw::Gain => None,
                _ if family.is_wrong() => Some(shares.hold()),
                _ => Some(shares.covered_is_not()),
            },
        }
    }
}

impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| 100.0 * share;
        write!(
            f,
            "{}: {:.1} % covered (50: {:.1}, 80: {:.1}), {:.0} % of scenes above 85 %, lowest {:.1} %, width {:.3}, failed {:.1} \
             % {}, p below 5 %: {:.1} %, doubted {:.1} % in {} scenes short, {:.1} % in {} covered ({})",
            self.family,
            percent(self.coverage95),
            percent(self.coverage50),
            percent(self.coverage80),
            percent(self.scenes_above_85),
            percent(self.lowest),
            self.width,
            percent(self.failed),
            self.failures,
            percent(self.below_5_percent.unwrap_or(f64::NAN)),
            percent(self.doubted_where_short),
            self.scenes_short,
            percent(self.doubted_where_covered),
            self.scenes_covered,
            self.doubts,
        )?;
        match self.is_within_limits {
            Some(false) => write!(f, ", beyond the limits"),
            _ => Ok(()),
        }
    }
}
