//! How often intervals of presses hold, and how wide they are.

use std::fmt;

use anyhow::Result;
use palpate_press::{Doubt, Interval, Measured, PressError};
use palpate_sensing::{Channel, Stream};
use serde::Serialize;

use super::super::doubted::{Doubts, Scene, Shares, words};
use super::super::sums::{HOLDS, Sums, within};
use super::case::{ALARMS, Case, Family, RADIUS};

/// How often the intervals of a family hold, over all its scenes. Lengths are mm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// The family.
    pub family: String,
    /// Number of scenes.
    pub scenes: usize,
    /// Share of trials whose readings show a contact of themselves; false alarms where nothing touches.
    pub seen: f64,
    /// Share of trials in which the best test with 5 % false alarms sees the contact, to which its place is unknown.
    pub detectable: f64,
    /// Share of trials that gave no interval; a miss of each.
    pub failed: f64,
    /// Names of what went wrong in them, with the share of trials that each did.
    pub failures: String,
    /// Share of intervals of 50 % that hold the truth.
    pub coverage50: f64,
    /// Share of intervals of 80 % that hold the truth.
    pub coverage80: f64,
    /// Share of intervals of 95 % that hold the truth.
    pub coverage95: f64,
    /// Share of scenes in which those of 95 % hold in at least 85 %.
    pub scenes_above_85: f64,
    /// Coverage of intervals of 95 % in the scene where it is lowest.
    pub lowest: f64,
    /// Median width of the closed intervals of 95 %, in curvatures of the sensor.
    pub width: f64,
    /// Share of intervals with two ends.
    pub closed: f64,
    /// Share of intervals with one end.
    pub one_sided: f64,
    /// Share of intervals without end.
    pub open: f64,
    /// Number of scenes whose intervals of 95 % hold in less than 85 %.
    pub scenes_short: usize,
    /// Share of doubted estimates in these, of those that failed too; those that leave markers out are.
    pub doubted_where_short: f64,
    /// Number of scenes whose intervals of 95 % hold in at least 92 % of the estimates.
    pub scenes_covered: usize,
    /// Share of doubted estimates in these, but for those that name the marker that slipped and no more.
    pub doubted_where_covered: f64,
    /// Mean over the scenes that fall short of the share of trials in which the best test with 5 % of false alarms tells the
    /// readings from those of any press that the fit believes in; NaN where they are those of one.
    pub tellable_where_short: f64,
    /// Share of estimates that leave markers out as wrong.
    pub left_out: f64,
    /// Names of the doubts, with the share of estimates that have each.
    pub doubts: String,
    /// Whether the figures are within the limits; `None` where none are set.
    pub is_within_limits: Option<bool>,
}

/// Sums over the trials of a scene.
#[derive(Default)]
pub(super) struct Tally {
    sums: Sums,
    /// Intervals with no, one and two ends.
    ends: [f64; 3],
    widths: Vec<f64>,
    failures: Doubts,
    seen: f64,
    detectable: f64,
    tellable: f64,
    refused: f64,
    doubts: Doubts,
    left_out: f64,
    /// Estimates that are doubted or leave markers out, and those of them that name the marker that slipped and no more.
    doubted: f64,
    rightly: f64,
}

impl Tally {
    /// Coverage of intervals of 95 % among these.
    fn coverage_of_stated(&self) -> f64 {
        self.sums.within[2] / (self.sums.stated + self.refused)
    }

    /// Share that is doubted of the estimates and of the presses that are refused as those of another body; where intervals
    /// `hold` all the same, without those that name the marker that slipped and no more.
    fn doubted(&self, hold: bool) -> f64 {
        let rightly = if hold { self.rightly } else { 0.0 };
        (self.doubted - rightly + self.refused) / (self.sums.stated + self.refused)
    }
}

/// The trials of a scene.
///
/// # Errors
/// None that a family makes.
pub(super) fn tally(case: &Case, trials: u64) -> Result<Tally> {
    let mut tally = Tally::default();
    tally.sums.asked = trials as f64;
    tally.tellable = case.tellable();
    for trial in 0..trials {
        let readings = case.readings.noisy(case.std, case.seed, trial);
        let mut stream = Stream::new(case.seed, trial, Channel::Indentation);
        let indentation = case.indentation.map(|known| Measured {
            value: known.value + known.std * stream.standard_normal(),
            ..known
        });
        tally.detectable += f64::from(u8::from(case.best_test.sees(&readings)));
        let reading = readings.reading(&case.markers, indentation);
        let estimate = match case.fit.estimate(&reading) {
            Ok(estimate) => estimate,
            Err(error) => {
                tally.failures.add(std::iter::once(error.name()));
                tally.refused += f64::from(u8::from(matches!(error, PressError::OtherBody { .. })));
                continue;
            }
        };
        tally.seen += f64::from(u8::from(estimate.is_seen));
        let doubts = case.fit.doubts(&reading, &estimate)?;
        tally.doubts.add(doubts.iter().map(|doubt| doubt.name()));
        let left_out = &estimate.wrong_markers;
        tally.left_out += f64::from(u8::from(!left_out.is_empty()));
        if !(left_out.is_empty() && doubts.is_empty()) {
            let slipped = case.readings.slipped;
            let is_right = |doubt: &Doubt| matches!(doubt, Doubt::SlippedMarker { marker, .. } if Some(*marker) == slipped);
            let is_rightly = doubts.iter().all(is_right)
                && left_out.iter().all(|&marker| Some(marker) == slipped);
            tally.doubted += 1.0;
            tally.rightly += f64::from(u8::from(is_rightly));
        }
        let curvature = estimate.relative_curvature;
        let error = curvature.value - case.relative_curvature;
        let [half, most, _] = within(error, curvature.std);
        let holds = curvature.interval.holds(case.relative_curvature);
        tally.sums.add(error, curvature.std, [half, most, holds]);
        let Interval { low, high } = curvature.interval;
        tally.ends[usize::from(low.is_some()) + usize::from(high.is_some())] += 1.0;
        tally
            .widths
            .extend(low.zip(high).map(|(low, high)| RADIUS * (high - low)));
    }
    Ok(tally)
}

/// Limits of the coverage of intervals of 95 %.
const SEEN: [f64; 2] = [0.92, 0.97];
const FAINT: [f64; 2] = [0.92, 0.98];

impl Score {
    /// The score of a family from its scenes.
    pub(super) fn of(family: &Family, scenes: &[Tally]) -> Self {
        let mean = |part: &dyn Fn(&Tally) -> f64| {
            scenes.iter().map(part).sum::<f64>() / scenes.len() as f64
        };
        let ends = |count: usize| mean(&|one| one.ends[count] / one.sums.asked);
        let mut widths: Vec<f64> = scenes.iter().flat_map(|one| one.widths.clone()).collect();
        widths.sort_by(f64::total_cmp);
        let asked = scenes.iter().map(|one| one.sums.asked).sum();
        let lowest = scenes.iter().map(|one| one.sums.coverage(2));
        let told: Vec<Scene> = scenes
            .iter()
            .map(|one| Scene {
                coverage: one.coverage_of_stated(),
                doubted: one.doubted(one.coverage_of_stated() >= HOLDS),
            })
            .collect();
        let shares = Shares::of(&told);
        let short = scenes.iter().filter(|one| one.coverage_of_stated() < HOLDS);
        let tellable = short.map(|one| one.tellable).sum::<f64>() / shares.short.0 as f64;
        let stated = scenes.iter().map(|one| one.sums.stated).sum();
        let score = Self {
            family: family.name(),
            scenes: scenes.len(),
            seen: mean(&|one| one.seen / one.sums.asked),
            detectable: mean(&|one| one.detectable / one.sums.asked),
            failed: mean(&|one| 1.0 - one.sums.stated / one.sums.asked),
            failures: words(scenes.iter().map(|one| &one.failures), asked),
            coverage50: mean(&|one| one.sums.coverage(0)),
            coverage80: mean(&|one| one.sums.coverage(1)),
            coverage95: mean(&|one| one.sums.coverage(2)),
            scenes_above_85: mean(&|one| f64::from(u8::from(one.sums.coverage(2) >= HOLDS))),
            lowest: lowest.fold(1.0, f64::min),
            width: widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN),
            closed: ends(2),
            one_sided: ends(1),
            open: ends(0),
            scenes_short: shares.short.0,
            doubted_where_short: shares.short.1,
            scenes_covered: shares.covered.0,
            doubted_where_covered: shares.covered.1,
            tellable_where_short: tellable,
            left_out: scenes.iter().map(|one| one.left_out).sum::<f64>() / stated,
            doubts: words(scenes.iter().map(|one| &one.doubts), stated),
            is_within_limits: None,
        };
        let within = |[low, high]: [f64; 2]| (low..=high).contains(&score.coverage95);
        let is_within_limits = match family {
            _ if family.cannot_be_told() => None,
            _ if family.is_wrong() => Some(shares.hold()),
            _ if !family.touches() => Some(score.seen <= ALARMS),
            _ if family.is_faint() => Some(within(FAINT)),
            _ => Some(within(SEEN)),
        };
        Self {
            is_within_limits,
            ..score
        }
    }
}

impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| 100.0 * share;
        write!(
            f,
            "{}: seen {:.1} % (at most {:.1}), {:.1} % covered (50: {:.1}, 80: {:.1}), {:.0} % of scenes above 85 %, lowest {:.1} %, width {:.2}, closed \
             {:.1} %, one-sided {:.1} %, open {:.1} %, failed {:.1} % {}, doubted {:.1} % in {} scenes short (at most {:.1}), {:.1} % \
             in {} covered, {:.1} % leave markers out ({})",
            self.family,
            percent(self.seen),
            percent(self.detectable),
            percent(self.coverage95),
            percent(self.coverage50),
            percent(self.coverage80),
            percent(self.scenes_above_85),
            percent(self.lowest),
            self.width,
            percent(self.closed),
            percent(self.one_sided),
            percent(self.open),
            percent(self.failed),
            self.failures,
            percent(self.doubted_where_short),
            self.scenes_short,
            percent(self.tellable_where_short),
            percent(self.doubted_where_covered),
            self.scenes_covered,
            percent(self.left_out),
            self.doubts,
        )?;
        match self.is_within_limits {
            Some(false) => write!(f, ", beyond the limits"),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene of twenty trials: of so many that failed, were covered, seen and doubted.
    fn scene(failed: u64, covered: u64, seen: u64, doubted: u64) -> Tally {
        let mut tally = Tally::default();
        tally.sums.asked = 20.0;
        for trial in 0..20 - failed {
            let holds = trial < covered;
            tally.sums.add(0.01, 0.01, [false, holds, holds]);
        }
        tally.seen = seen as f64;
        tally.doubted = doubted as f64;
        tally
    }

    fn family(word: &str) -> Family {
        let named = |family: &Family| family.name().contains(word);
        Family::all().into_iter().find(named).unwrap()
    }

    #[test]
    fn failures_are_misses() {
        let score = Score::of(
            &family("half-space, indentation known"),
            &[scene(2, 18, 18, 0)],
        );
        assert_eq!(score.coverage95, 0.9);
        assert!((score.failed - 0.1).abs() < 1e-12);
        assert_eq!(score.is_within_limits, Some(false));
        assert_eq!((score.scenes_short, score.scenes_covered), (0, 1));
        let sound = scene(1, 19, 19, 0);
        let score = Score::of(&family("half-space, indentation known"), &[sound]);
        assert_eq!(score.is_within_limits, Some(true));
    }

    #[test]
    fn contacts_that_are_seen_where_nothing_touches_are_false_alarms() {
        let nothing = family("nothing touches");
        let of = |seen: u64| Score::of(&nothing, &[scene(0, 0, seen, 0)]).is_within_limits;
        assert_eq!([of(1), of(2)], [Some(true), Some(false)]);
    }

    #[test]
    fn a_slipped_marker_that_is_named_is_no_false_doubt() {
        let named = |covered: u64| {
            let mut tally = scene(0, covered, 20, 0);
            (tally.doubted, tally.rightly) = (10.0, 8.0);
            tally
        };
        let score = Score::of(&family("a slipped marker"), &[named(4), named(19)]);
        let shares = [score.doubted_where_short, score.doubted_where_covered];
        assert_eq!(shares, [0.5, 0.1]);
    }

    #[test]
    fn wrong_models_are_judged_by_their_doubts() {
        let edge = family("an edge");
        let of = |scenes: &[Tally]| Score::of(&edge, scenes).is_within_limits;
        assert_eq!(of(&[scene(0, 4, 20, 18)]), Some(true));
        assert_eq!(of(&[scene(0, 4, 20, 17)]), Some(false));
        assert_eq!(of(&[scene(0, 20, 20, 1)]), Some(true));
        assert_eq!(of(&[scene(0, 20, 20, 2)]), Some(false));
        assert_eq!(
            Score::of(&family("wrong gain"), &[scene(0, 4, 20, 0)]).is_within_limits,
            None
        );
    }
}
