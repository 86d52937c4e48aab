//! How often estimates of glides are doubted, where their intervals hold and where they do not.

use std::collections::BTreeSet;
use std::fmt;

use anyhow::Result;
use nalgebra::Vector3;
use palpate_ep2::{Curvature, Ep2Error, Method, Patch, Penalised};
use serde::Serialize;

use super::super::case::Sweep;
use super::super::doubted::{Doubts, Scene, Shares, words};
use super::super::options::Options;
use super::super::sums::{HOLDS, Sums, within};
use super::super::surface::Surface;
use super::best_test::BestTest;
use super::family::Family;
use super::flaw::{Flaw, displacement};

/// How often the estimates of a family are doubted, over all its scenes.
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
    /// Share of intervals of 50 % that hold the truth, of Gaussian and mean curvature over the patch.
    pub coverage50: f64,
    /// Share of intervals of 80 % that hold the truth.
    pub coverage80: f64,
    /// Share of intervals of 95 % that hold the truth.
    pub coverage95: f64,
    /// Share of scenes in which those of 95 % hold in at least 85 %.
    pub scenes_above_85: f64,
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
    /// Mean over the scenes that fall short of the share of glides in which the best test with 5 % of false alarms tells that a
    /// finger is displaced; NaN where none is.
    pub tellable_where_short: f64,
    /// Names of the doubts, with the share of estimates that have each.
    pub doubts: String,
    /// Whether the doubts are within the limits.
    pub is_within_limits: bool,
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
    tellable: f64,
}

impl Tally {
    /// Coverage of intervals of 95 % among those that are stated.
    fn coverage(&self) -> f64 {
        self.sums.within[2] / self.sums.stated
    }
}

/// The trials of the scene of this number.
///
/// # Errors
/// A case that cannot be asked.
pub(super) fn tally(family: &Family, number: u64, options: Options<'_>) -> Result<Tally> {
    let Family { case, flaw } = family;
    let surface = Surface::random(options.seed, number);
    let sweep = Sweep::random(options.seed, number);
    let asked = sweep.asked(&surface);
    let mut tally = Tally {
        tellable: f64::NAN,
        ..Tally::default()
    };
    if *flaw == Flaw::Displaced {
        let test = BestTest::new(case, &sweep, &surface, options.seed);
        let (finger, by) = displacement(case, options.seed, number);
        tally.tellable = test.map_or(f64::NAN, |test| test.tells(finger, by));
    }
    for trial in 0..options.trials {
        let place = number * options.trials + trial;
        let mut contacts = case.contacts(&surface, &sweep, options.seed, place)?;
        flaw.spoil(case, &mut contacts, options.seed, number);
        tally.sums.asked += 2.0 * asked.len() as f64;
        let method = Penalised {
            noise: flaw.told(case.told()),
            ..Penalised::default()
        };
        let told = Patch::new(&contacts, &Vector3::z()).and_then(|patch| {
            let fit = method.fit(&patch)?;
            let places = asked.iter().map(|place| fit.curvature_at(&place.point));
            let curvatures = places.collect::<Result<Vec<Curvature>, Ep2Error>>()?;
            Ok((curvatures, method.agreement(&patch)?))
        });
        let (curvatures, agreement) = match told {
            Ok(told) => told,
            Err(error) => {
                tally.failures.insert(error.name());
                continue;
            }
        };
        tally.estimates += 1.0;
        tally
            .doubts
            .add(agreement.doubts.iter().map(|doubt| doubt.name()));
        if let Some(goodness) = agreement.goodness {
            tally.goodness += 1.0;
            tally.unlikely += f64::from(u8::from(goodness.p_value < 0.05));
        }
        for (curvature, place) in curvatures.iter().zip(&asked) {
            let Some(told) = curvature.uncertainty else {
                continue;
            };
            let [gaussian, mean] = place.curvatures;
            let errors = [
                (curvature.gaussian - gaussian, told.gaussian_std),
                (curvature.mean - mean, told.mean_std),
            ];
            for (error, std) in errors {
                tally.sums.add(error, std, within(error, std));
            }
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
        let told: Vec<Scene> = scenes
            .iter()
            .filter(|one| one.estimates > 0.0)
            .map(|one| Scene {
                coverage: one.coverage(),
                doubted: one.doubts.doubted() / one.estimates,
            })
            .collect();
        let shares = Shares::of(&told);
        let goodness = sum(&|one| one.goodness);
        let short = scenes.iter().filter(|one| one.coverage() < HOLDS);
        let tellable = short.map(|one| one.tellable).sum::<f64>() / shares.short.0 as f64;
        Self {
            family: family.name(),
            scenes: scenes.len(),
            failed: mean(&|one| 1.0 - one.sums.stated / one.sums.asked),
            failures: failures.into_iter().collect::<Vec<_>>().join(" "),
            coverage50: mean(&|one| one.sums.coverage(0)),
            coverage80: mean(&|one| one.sums.coverage(1)),
            coverage95: mean(&|one| one.sums.coverage(2)),
            scenes_above_85: mean(&|one| f64::from(u8::from(one.sums.coverage(2) >= HOLDS))),
            below_5_percent: (goodness > 0.0).then(|| sum(&|one| one.unlikely) / goodness),
            scenes_short: shares.short.0,
            doubted_where_short: shares.short.1,
            scenes_covered: shares.covered.0,
            doubted_where_covered: shares.covered.1,
            tellable_where_short: tellable,
            doubts: words(
                scenes.iter().map(|one| &one.doubts),
                sum(&|one| one.estimates),
            ),
            is_within_limits: match family.flaw {
                Flaw::None => shares.covered_is_not(),
                _ => shares.hold(),
            },
        }
    }
}

impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| 100.0 * share;
        write!(
            f,
            "{}: {:.1} % covered, {:.0} % of scenes above 85 %, failed {:.1} % {}, p below 5 %: {:.1} %, doubted {:.1} % in {} \
             scenes short (the best test tells {:.1} %), {:.1} % in {} covered ({})",
            self.family,
            percent(self.coverage95),
            percent(self.scenes_above_85),
            percent(self.failed),
            self.failures,
            percent(self.below_5_percent.unwrap_or(f64::NAN)),
            percent(self.doubted_where_short),
            self.scenes_short,
            percent(self.tellable_where_short),
            percent(self.doubted_where_covered),
            self.scenes_covered,
            self.doubts,
        )?;
        match self.is_within_limits {
            false => write!(f, ", beyond the limits"),
            true => Ok(()),
        }
    }
}
