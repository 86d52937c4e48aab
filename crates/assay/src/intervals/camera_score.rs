//! Scores of presses with a camera: coverage and width of the intervals of a scene, its errors relative to the Cramér–Rao
//! bound, and the summary of a family.

use palpate_press::Interval;
use palpate_scene::CurvatureScore;
use palpate_statistics::NORMAL_95;
use serde::Serialize;

use super::camera_case::{Case, Family};
use super::coverage::{MIN_COVERAGE, Sums};
use super::false_alarms::{NameCounts, SceneWarnings, WarningShares};

/// Estimated curvature of a trial, or the name of its error.
pub(super) type Estimate = Result<CurvatureScore, &'static str>;

/// P-value below which residuals are large.
const SMALL_P_VALUE: f64 = 0.05;
/// Name of the error of presses that no press of the assumed body explains. They count as estimates with a warning.
const REJECTED: &str = "other-body";

/// Row of the table: the intervals of a scene. Lengths are mm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Family of the scene.
    pub family: &'static str,
    /// Number of the scene.
    pub scene: u64,
    /// Curvature of the object.
    pub object_curvature: f64,
    /// Indentation.
    pub indentation: f64,
    /// Whether the indentation is fitted instead of stated.
    pub fits_indentation: bool,
    /// Polar angle of the contact, degrees.
    pub polar_deg: f64,
    /// Thickness of the layer.
    pub thickness: f64,
    /// Largest misalignment of the discs, a share of their diameter.
    pub misalignment: f64,
    /// Pixels along a side of the image.
    pub size_px: u32,
    /// Noise of the pixels, levels of 255.
    pub pixel_std: f64,
    /// Number of trials.
    pub trials: usize,
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
    /// Mean error over the standard deviation of the errors.
    pub mean_per_scatter: f64,
    /// Root mean square of the errors.
    pub rms: f64,
    /// Ratio of the rms error to the Cramér–Rao bound from the covariances of the tracker and the calibration.
    pub rms_per_bound: f64,
    /// Ratio of the rms error to the bound from the pixels of the pressed frame alone, with all other parameters known.
    pub rms_per_pixel_bound: f64,
    /// Mean width of the closed intervals of 95 %, over 3.92 times the root mean square of the errors.
    pub width_per_rms: f64,
    /// Stated standard deviation over error, both root mean squares.
    pub std_per_rms: f64,
    /// Share of intervals with two ends.
    pub closed: f64,
    /// Share of intervals with one end.
    pub one_sided: f64,
    /// Share of intervals without an end.
    pub open: f64,
    /// Share of estimates with a warning; presses that are rejected as those of another body count too.
    pub doubted: f64,
    /// Names of the warnings, with the share of estimates that have each.
    pub doubts: String,
    /// Share of fits with a p-value below 0.05; it is 0.05 for a right model.
    pub small_p_values: f64,
    /// Kolmogorov distance of the p-values from the uniform distribution.
    pub p_value_distance: f64,
}

/// Score of a scene from its trials.
pub(super) fn score(case: &Case, trials: &[Estimate], pixel_bound: Option<f64>) -> Score {
    let mut sums = Sums::new(trials.len() as f64);
    let (mut ends, mut width, mut bound, mut bounds) = ([0.0; 3], 0.0, 0.0, 0.0);
    let (mut failures, mut warnings) = (NameCounts::default(), NameCounts::default());
    let (mut warned, mut rejected, mut p_values) = (0.0, 0.0, Vec::new());
    for trial in trials {
        let estimate = match trial {
            Ok(estimate) => estimate,
            Err(name) => {
                failures.add([*name]);
                rejected += f64::from(u8::from(*name == REJECTED));
                continue;
            }
        };
        let curvature = &estimate.estimated;
        sums.add_hits(
            curvature.value - estimate.truth,
            curvature.std,
            estimate.holds,
        );
        let names = estimate.misfits.iter().map(|warning| warning.code());
        warned += f64::from(u8::from(warnings.add(names)));
        p_values.extend(estimate.p_value);
        let Interval { low, high } = curvature.interval;
        ends[usize::from(low.is_some()) + usize::from(high.is_some())] += 1.0;
        if let (Some(low), Some(high)) = (low, high) {
            width += high - low;
        }
        if let Some(std) = estimate.std_bound {
            bound += std * std;
            bounds += 1.0;
        }
    }
    let rms = sums.rms();
    let is_small = |p_value: &&f64| **p_value < SMALL_P_VALUE;
    Score {
        family: case.family.name(),
        scene: case.number,
        object_curvature: case.curvature(),
        indentation: case.indentation,
        fits_indentation: case.fits_indentation,
        polar_deg: case.polar_deg,
        thickness: case.thickness,
        misalignment: case.misalignment,
        size_px: case.size_px,
        pixel_std: case.pixel_std,
        trials: trials.len(),
        failed: 1.0 - sums.estimates / sums.attempts,
        failures: failures.names(),
        coverage50: sums.coverage(0),
        coverage80: sums.coverage(1),
        coverage95: sums.coverage(2),
        mean_per_scatter: sums.mean_per_scatter(),
        rms,
        rms_per_bound: rms / (bound / bounds).sqrt(),
        rms_per_pixel_bound: pixel_bound.map_or(f64::NAN, |bound| rms / bound),
        width_per_rms: width / ends[2] / (2.0 * NORMAL_95 * rms),
        std_per_rms: sums.std_per_rms(),
        closed: ends[2] / sums.attempts,
        one_sided: ends[1] / sums.attempts,
        open: ends[0] / sums.attempts,
        doubted: (warned + rejected) / (sums.estimates + rejected),
        doubts: warnings.shares(sums.estimates),
        small_p_values: p_values.iter().filter(is_small).count() as f64 / p_values.len() as f64,
        p_value_distance: distance_from_uniform(p_values),
    }
}

/// Kolmogorov distance of numbers from the uniform distribution from 0 to 1.
fn distance_from_uniform(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let count = numbers.len() as f64;
    let apart = |(index, number): (usize, &f64)| {
        let rank = index as f64;
        (number - rank / count).max((rank + 1.0) / count - number)
    };
    numbers.iter().enumerate().map(apart).fold(0.0, f64::max)
}

/// Smallest and largest coverage of 95 % intervals over all scenes.
const COVERAGE: [f64; 2] = [0.92, 0.97];
/// Smallest share of scenes with a coverage of at least 85 %.
const MIN_SCENES_ABOVE_85: f64 = 0.95;
/// Largest mean error, relative to the standard deviation of the errors.
const MAX_MEAN: f64 = 0.3;
/// Largest rms error, relative to the Cramér–Rao bound.
const MAX_RMS: f64 = 1.3;
/// Largest mean width of closed 95 % intervals, relative to that of normal errors with the same rms.
const MAX_WIDTH: f64 = 1.5;

/// All scenes of a family together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The family.
    pub family: &'static str,
    /// Number of scenes.
    pub scenes: usize,
    /// Share of 95 % intervals that contain the true value, over all scenes.
    pub coverage95: f64,
    /// Number of scenes with a 95 % coverage of at least 85 %.
    pub scenes_above_85: usize,
    /// Number of scenes with a mean error of at most 0.3 of the scatter.
    pub unbiased: usize,
    /// Rms error relative to the bound: root mean square over the scenes.
    pub rms_per_bound: f64,
    /// Number of scenes with a ratio of at most 1.3.
    pub efficient: usize,
    /// Rms error relative to the bound from the pixels: root mean square over the scenes.
    pub rms_per_pixel_bound: f64,
    /// Width of closed intervals relative to that of normal errors with the same rms: mean over the scenes.
    pub width_per_rms: f64,
    /// Share of intervals with two ends.
    pub closed: f64,
    /// Share of intervals with one end.
    pub one_sided: f64,
    /// Share of intervals without an end.
    pub open: f64,
    /// Share of trials without an interval.
    pub failed: f64,
    /// Share of fits with a p-value below 0.05.
    pub small_p_values: f64,
    /// Share of estimates with a warning in scenes with a coverage below 85 %.
    pub doubted_where_short: f64,
    /// Share of estimates with a warning in scenes with a coverage of at least 92 %.
    pub doubted_where_covered: f64,
    /// Whether the family meets its limits.
    pub is_within_limits: bool,
}

impl Summary {
    /// The summary of scenes of a family; `None` without a scene.
    pub(super) fn new(family: Family, scores: &[&Score]) -> Option<Self> {
        if scores.is_empty() {
            return None;
        }
        // The errors of a scene without estimates are NaN.
        let mean = |part: &dyn Fn(&Score) -> f64| {
            let parts = scores.iter().map(|one| part(one));
            let parts: Vec<f64> = parts.filter(|part| !part.is_nan()).collect();
            parts.iter().sum::<f64>() / parts.len() as f64
        };
        let count = |is: &dyn Fn(&Score) -> bool| scores.iter().filter(|one| is(one)).count();
        let warnings: Vec<SceneWarnings> = scores.iter().map(warnings).collect();
        let warnings = WarningShares::new(&warnings);
        let summary = Self {
            family: family.name(),
            scenes: scores.len(),
            coverage95: mean(&|one| one.coverage95),
            scenes_above_85: count(&|one| one.coverage95 >= MIN_COVERAGE),
            unbiased: count(&|one| one.mean_per_scatter.abs() <= MAX_MEAN),
            rms_per_bound: mean(&|one| one.rms_per_bound.powi(2)).sqrt(),
            efficient: count(&|one| one.rms_per_bound <= MAX_RMS),
            rms_per_pixel_bound: mean(&|one| one.rms_per_pixel_bound.powi(2)).sqrt(),
            width_per_rms: mean(&|one| one.width_per_rms),
            closed: mean(&|one| one.closed),
            one_sided: mean(&|one| one.one_sided),
            open: mean(&|one| one.open),
            failed: mean(&|one| one.failed),
            small_p_values: mean(&|one| one.small_p_values),
            doubted_where_short: warnings.short.1,
            doubted_where_covered: warnings.covered.1,
            is_within_limits: warnings.meet_limits(),
        };
        Some(Self {
            is_within_limits: summary.is_within_limits
                && (family.is_wrong() || summary.meets_limits_of_a_sound_family()),
            ..summary
        })
    }

    fn meets_limits_of_a_sound_family(&self) -> bool {
        (COVERAGE[0]..=COVERAGE[1]).contains(&self.coverage95)
            && self.scenes_above_85 as f64 >= MIN_SCENES_ABOVE_85 * self.scenes as f64
            && self.unbiased == self.scenes
            && self.rms_per_bound <= MAX_RMS
            && self.width_per_rms <= MAX_WIDTH
    }
}

/// Coverage among the estimates of a scene, and the share of them with a warning.
fn warnings(score: &&Score) -> SceneWarnings {
    SceneWarnings {
        coverage: score.coverage95 / (1.0 - score.failed),
        warned: score.doubted,
    }
}

#[cfg(test)]
mod tests {
    use palpate_press::Estimated;

    use super::*;

    fn estimate(error: f64, high: Option<f64>) -> Estimate {
        Ok(CurvatureScore {
            estimated: Estimated {
                value: 0.1 + error,
                std: 0.01,
                interval: Interval {
                    low: Some(0.08),
                    high,
                },
            },
            truth: 0.1,
            holds: [error.abs() < 0.006, error.abs() < 0.012, error.abs() < 0.02],
            std_bound: Some(0.01),
            p_value: Some(0.5),
            misfits: Vec::new(),
        })
    }

    #[test]
    fn trials_are_summed_up() {
        let case = Case::random(Family::Sound, 1, 0);
        let trials = [
            estimate(0.01, Some(0.12)),
            estimate(-0.01, None),
            estimate(0.03, Some(0.14)),
            Err("no-contact"),
        ];
        let score = score(&case, &trials, Some(0.005));
        assert_eq!(
            [score.coverage50, score.coverage80, score.coverage95],
            [0.0, 0.5, 0.5]
        );
        assert_eq!(
            (score.failures.as_str(), score.failed),
            ("no-contact", 0.25)
        );
        assert_eq!(
            [score.closed, score.one_sided, score.open],
            [0.5, 0.25, 0.0]
        );
        let rms = (0.0011_f64 / 3.0).sqrt();
        assert!((score.rms_per_bound - rms / 0.01).abs() < 1e-9);
        assert!((score.rms_per_pixel_bound - rms / 0.005).abs() < 1e-9);
        assert!((score.width_per_rms - 0.05 / (2.0 * NORMAL_95 * rms)).abs() < 1e-9);
        assert_eq!((score.doubted, score.small_p_values), (0.0, 0.0));
        assert!((score.p_value_distance - 0.5).abs() < 1e-12);
        let summary = Summary::new(Family::Sound, &[&score]).unwrap();
        assert!(!summary.is_within_limits);
        assert_eq!(Summary::new(Family::Sound, &[]), None);
    }

    #[test]
    fn all_scenes_count_alike() {
        let case = Case::random(Family::Sound, 1, 0);
        let trials: Vec<Estimate> = (0..100)
            .map(|trial| {
                let error = if trial % 20 == 0 { 0.021 } else { 0.0088 };
                estimate(if trial % 2 == 0 { error } else { -error }, Some(0.12))
            })
            .collect();
        let good = score(&case, &trials, Some(0.01));
        let summary = Summary::new(Family::Sound, &[&good, &good]).unwrap();
        assert!(summary.is_within_limits, "{summary:?}");
        let bad = Score {
            coverage95: 0.5,
            ..good.clone()
        };
        let of = |family, one: &Score| Summary::new(family, &[one]).unwrap();
        assert!(!of(Family::Sound, &bad).is_within_limits);
        // A wrong model must get a warning if its intervals are wrong.
        assert!(!of(Family::LayerForHalfSpace, &bad).is_within_limits);
        let warned = Score {
            doubted: 0.9,
            ..bad
        };
        assert!(of(Family::LayerForHalfSpace, &warned).is_within_limits);
        let warned = Score {
            doubted: 0.06,
            ..good
        };
        assert!(!of(Family::Sound, &warned).is_within_limits);
    }
}
