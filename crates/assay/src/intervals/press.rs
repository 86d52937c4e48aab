//! Coverage of the intervals of presses without a camera: clear and faint ones, readings without contact, and readings that
//! contradict the model of the fit.

use anyhow::Result;
use palpate_press::{Interval, Measured, Misfit, PressError};
use palpate_sensing::{Channel, Stream};
use palpate_statistics::HALF_WIDTHS;

use super::best_test::FALSE_ALARMS;
use super::coverage::{Score, Sums, Tally, contain_truth, detectable_where_short};
use super::false_alarms::NameCounts;
use super::press_case::{Case, Family, RADIUS};
use super::{Options, case_scores, scenes};

/// Smallest and largest coverage of 95 % intervals of clear presses, and of faint ones.
const CLEAR_COVERAGE: [f64; 2] = [0.92, 0.97];
const FAINT_COVERAGE: [f64; 2] = [0.92, 0.98];

/// Scores of all families. `report` gets each as soon as it is computed.
///
/// # Errors
/// If a scene cannot be set up, or `report` fails.
pub fn scores(options: Options<'_>, report: impl Fn(&Score) -> Result<()>) -> Result<Vec<Score>> {
    case_scores(Family::all(), Family::name, options, report, |family| {
        let scenes = scenes(options, |number| {
            tally(
                &Case::random(*family, options.seed, number)?,
                options.trials,
            )
        })?;
        Ok([score(family, &scenes)])
    })
}

/// Counts over the trials of a scene.
#[derive(Default)]
struct PressTally {
    common: Tally,
    /// Numbers of intervals with no, one and two ends.
    ends: [f64; 3],
    /// Widths of the intervals with two ends.
    widths: Vec<f64>,
    /// Number of readings that show a contact, and of those in which the best test detects it.
    seen: f64,
    detected: f64,
    left_out: f64,
}

/// Trials of a scene.
fn tally(case: &Case, trials: u64) -> Result<PressTally> {
    let mut tally = PressTally {
        common: Tally {
            sums: Sums::new(trials as f64),
            detectable: case.detectable(),
            ..Tally::default()
        },
        ..PressTally::default()
    };
    let common = &mut tally.common;
    for trial in 0..trials {
        let readings = case.readings.noisy(case.std, case.seed, trial);
        let mut stream = Stream::new(case.seed, trial, Channel::Indentation);
        let indentation = case.indentation.map(|stated| Measured {
            value: stated.value + stated.std * stream.standard_normal(),
            ..stated
        });
        tally.detected += f64::from(u8::from(case.best_test.detects(&readings)));
        let reading = readings.reading(&case.markers, indentation);
        let estimate = match case.fit.estimate(&reading) {
            Ok(estimate) => estimate,
            Err(error) => {
                common.failures.add([error.name()]);
                let is_rejected = matches!(error, PressError::OtherBody { .. });
                common.rejected += f64::from(u8::from(is_rejected));
                continue;
            }
        };
        tally.seen += f64::from(u8::from(estimate.is_detected));
        let mut warnings = case.fit.misfits(&reading, &estimate)?;
        let stated = case.fit.check_indentation(&reading, Some(&estimate));
        warnings.extend(stated.ok().flatten());
        common.add_estimate(None, warnings.iter().map(|warning| warning.code()));
        let left_out = &estimate.wrong_markers;
        if !left_out.is_empty() {
            tally.left_out += 1.0;
            common.warned += f64::from(u8::from(warnings.is_empty()));
        }
        let slipped = case.readings.slipped;
        let names_slip = |warning: &Misfit| matches!(warning, Misfit::Outlier { reading, .. } if Some(*reading) == slipped);
        let is_right = warnings.iter().all(names_slip)
            && left_out.iter().all(|&marker| Some(marker) == slipped);
        let is_warned = !(warnings.is_empty() && left_out.is_empty());
        common.rightly_warned += f64::from(u8::from(is_warned && is_right));
        let curvature = estimate.relative_curvature;
        let error = curvature.value - case.relative_curvature;
        let [half, most, _] = contain_truth(error, curvature.std, HALF_WIDTHS);
        let contains = curvature.interval.holds(case.relative_curvature);
        common
            .sums
            .add_hits(error, curvature.std, [half, most, contains]);
        let Interval { low, high } = curvature.interval;
        tally.ends[usize::from(low.is_some()) + usize::from(high.is_some())] += 1.0;
        let width = low.zip(high).map(|(low, high)| RADIUS * (high - low));
        tally.widths.extend(width);
    }
    Ok(tally)
}

/// Score of a family from its scenes.
fn score(family: &Family, scenes: &[PressTally]) -> Score {
    let per_trial = |part: &dyn Fn(&PressTally) -> f64| {
        let shares = scenes
            .iter()
            .map(|one| part(one) / one.common.sums.attempts);
        Some(shares.sum::<f64>() / scenes.len() as f64)
    };
    let mut widths: Vec<f64> = scenes.iter().flat_map(|one| one.widths.clone()).collect();
    widths.sort_by(f64::total_cmp);
    let all: Vec<&Tally> = scenes.iter().map(|one| &one.common).collect();
    let attempts = all.iter().map(|one| one.sums.attempts).sum();
    let estimates: f64 = all.iter().map(|one| one.estimates).sum();
    let left_out: f64 = scenes.iter().map(|one| one.left_out).sum();
    let (score, shares) = Score::new(family.name(), &all);
    let seen = per_trial(&|one| one.seen);
    let covers = |[low, high]: [f64; 2]| (low..=high).contains(&score.coverage95);
    Score {
        is_within_limits: match family {
            _ if family.is_undetectable() => None,
            _ if family.is_wrong() => Some(shares.meet_limits()),
            _ if !family.touches() => seen.map(|seen| seen <= FALSE_ALARMS),
            _ if family.is_faint() => Some(covers(FAINT_COVERAGE)),
            _ => Some(covers(CLEAR_COVERAGE)),
        },
        seen,
        detectable: per_trial(&|one| one.detected),
        failures: NameCounts::total(all.iter().map(|one| &one.failures)).shares(attempts),
        width: Some(widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN)),
        closed: per_trial(&|one| one.ends[2]),
        one_sided: per_trial(&|one| one.ends[1]),
        open: per_trial(&|one| one.ends[0]),
        tellable_where_short: Some(detectable_where_short(&all)),
        left_out: Some(left_out / estimates),
        ..score
    }
}

/// Configs of presses with the smallest and the largest values of each sound family, with the family's name. Lengths, angles
/// and noise are divided or multiplied by `factor`.
#[cfg(test)]
pub(super) fn configs(factor: f64) -> Vec<(String, String)> {
    let sound = Family::all().into_iter().filter(Family::is_sound);
    let ends = |family: Family| [0, 1].map(|end| (family.name(), family.config(end, factor)));
    sound.flat_map(ends).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene of twenty trials: of so many that failed, were covered, show a contact and have a warning.
    fn scene(failed: u64, covered: u64, seen: u64, warned: u64) -> PressTally {
        let mut tally = PressTally {
            seen: seen as f64,
            ..PressTally::default()
        };
        tally.common.sums = Sums::new(20.0);
        tally.common.estimates = (20 - failed) as f64;
        tally.common.warned = warned as f64;
        for trial in 0..20 - failed {
            let hit = trial < covered;
            tally.common.sums.add_hits(0.01, 0.01, [false, hit, hit]);
        }
        tally
    }

    fn family(word: &str) -> Family {
        let named = |family: &Family| family.name().contains(word);
        Family::all().into_iter().find(named).unwrap()
    }

    #[test]
    fn failures_are_misses() {
        let known = family("half-space, indentation known");
        let failing = score(&known, &[scene(2, 18, 18, 0)]);
        assert_eq!(failing.coverage95, 0.9);
        assert!((failing.failed - 0.1).abs() < 1e-12);
        assert_eq!(failing.is_within_limits, Some(false));
        assert_eq!((failing.scenes_short, failing.scenes_covered), (0, 1));
        let sound = score(&known, &[scene(1, 19, 19, 0)]);
        assert_eq!(sound.is_within_limits, Some(true));
    }

    #[test]
    fn contacts_that_are_seen_where_nothing_touches_are_false_alarms() {
        let nothing = family("nothing touches");
        let of = |seen: u64| score(&nothing, &[scene(0, 0, seen, 0)]).is_within_limits;
        assert_eq!([of(1), of(2)], [Some(true), Some(false)]);
    }

    #[test]
    fn a_warning_that_names_the_slipped_marker_is_no_false_alarm() {
        let named = |covered: u64| {
            let mut tally = scene(0, covered, 20, 10);
            tally.common.rightly_warned = 8.0;
            tally
        };
        let score = score(&family("a slipped marker"), &[named(4), named(19)]);
        let shares = [score.doubted_where_short, score.doubted_where_covered];
        assert_eq!(shares, [0.5, 0.1]);
    }

    #[test]
    fn limits_of_wrong_models_concern_their_warnings() {
        let edge = family("an edge");
        let of = |scene| score(&edge, &[scene]).is_within_limits;
        assert_eq!(of(scene(0, 4, 20, 18)), Some(true));
        assert_eq!(of(scene(0, 4, 20, 17)), Some(false));
        assert_eq!(of(scene(0, 20, 20, 1)), Some(true));
        assert_eq!(of(scene(0, 20, 20, 2)), Some(false));
        let gain = score(&family("wrong gain"), &[scene(0, 4, 20, 0)]);
        assert_eq!(gain.is_within_limits, None);
    }
}
