//! How often the intervals of presses hold, how wide they are, and how far from what can be reached.

use std::fmt;

use palpate_press::Interval;
use palpate_scene::JudgedCurvature;
use palpate_statistics::{NORMAL_95, Number};
use serde::Serialize;

use super::super::doubted::{Doubts, words};
use super::super::sums::Sums;
use super::case::Case;

/// The curvature of a trial, or the name of what went wrong.
pub(super) type Judged = Result<JudgedCurvature, &'static str>;

/// P-value below which residuals are large.
const SMALL: f64 = 0.05;
/// Name of the refusal of presses that the body does not make.
const REFUSED: &str = "other-body";

/// How often the intervals of a scene hold. Lengths are mm.
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
    /// Whether the indentation is fitted, not given.
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
    /// Share of trials that gave no interval; a miss of each.
    pub failed: f64,
    /// Names of what went wrong in them.
    pub failures: String,
    /// Share of intervals of 50 % that hold the truth.
    pub coverage50: f64,
    /// Share of intervals of 80 % that hold the truth.
    pub coverage80: f64,
    /// Share of intervals of 95 % that hold the truth.
    pub coverage95: f64,
    /// Mean error over the errors' standard deviation.
    pub mean_per_scatter: f64,
    /// Root mean square of the errors.
    pub rms: f64,
    /// Ratio of the rms error to the Cramér–Rao bound by the tracker's covariance and the calibration's.
    pub rms_per_bound: f64,
    /// Ratio of the rms error to the bound by the pixels of the pressed frame alone, all else being known.
    pub rms_per_pixel_bound: f64,
    /// Mean width of the closed intervals of 95 %, over 3.92 times the root mean square of the errors.
    pub width_per_rms: f64,
    /// Stated standard deviation over error, both root mean squares.
    pub std_per_rms: f64,
    /// Share of intervals with two ends.
    pub closed: f64,
    /// Share of intervals with one end.
    pub one_sided: f64,
    /// Share of intervals without end.
    pub open: f64,
    /// Share of doubted estimates, and of presses that are refused as those of another body.
    pub doubted: f64,
    /// Names of the doubts, with the share of estimates that have each.
    pub doubts: String,
    /// Share of fits whose p-value is below 0.05; as much where it is right.
    pub small_p_values: f64,
    /// Kolmogorov's distance of the p-values from the uniform distribution.
    pub p_value_distance: f64,
}

/// The score of a scene from its trials.
pub(super) fn score(case: &Case, judged: &[Judged], pixel_bound: Option<f64>) -> Score {
    let mut sums = Sums {
        asked: judged.len() as f64,
        ..Sums::default()
    };
    let (mut ends, mut width, mut bound, mut bounds) = ([0.0; 3], 0.0, 0.0, 0.0);
    let mut failures: Vec<&str> = Vec::new();
    let (mut doubts, mut p_values) = (Doubts::default(), Vec::new());
    for one in judged {
        let one = match one {
            Ok(one) => one,
            Err(name) => {
                failures.push(name);
                continue;
            }
        };
        sums.add(
            one.estimated.value - one.truth,
            one.estimated.std,
            one.holds,
        );
        doubts.add(one.doubts.iter().map(|doubt| doubt.name()));
        p_values.extend(one.p_value);
        let Interval { low, high } = one.estimated.interval;
        ends[usize::from(low.is_some()) + usize::from(high.is_some())] += 1.0;
        if let (Some(low), Some(high)) = (low, high) {
            width += high - low;
        }
        if let Some(std) = one.std_bound {
            bound += std * std;
            bounds += 1.0;
        }
    }
    let refused = failures.iter().filter(|&&name| name == REFUSED).count() as f64;
    failures.sort_unstable();
    failures.dedup();
    let rms = sums.rms();
    let small = p_values.iter().filter(|&&p_value| p_value < SMALL).count();
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
        trials: judged.len(),
        failed: 1.0 - sums.stated / sums.asked,
        failures: failures.join(" "),
        coverage50: sums.coverage(0),
        coverage80: sums.coverage(1),
        coverage95: sums.coverage(2),
        mean_per_scatter: sums.mean_per_scatter(),
        rms,
        rms_per_bound: rms / (bound / bounds).sqrt(),
        rms_per_pixel_bound: pixel_bound.map_or(f64::NAN, |bound| rms / bound),
        width_per_rms: width / ends[2] / (2.0 * NORMAL_95 * rms),
        std_per_rms: sums.std_per_rms(),
        closed: ends[2] / sums.asked,
        one_sided: ends[1] / sums.asked,
        open: ends[0] / sums.asked,
        doubted: (doubts.doubted() + refused) / (sums.stated + refused),
        doubts: words([&doubts].into_iter(), sums.stated),
        small_p_values: small as f64 / p_values.len() as f64,
        p_value_distance: distance_from_uniform(p_values),
    }
}

/// Kolmogorov's distance of numbers from the uniform distribution from 0 to 1.
fn distance_from_uniform(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let count = numbers.len() as f64;
    let apart = |(index, number): (usize, &f64)| {
        let rank = index as f64;
        (number - rank / count).max((rank + 1.0) / count - number)
    };
    numbers.iter().enumerate().map(apart).fold(0.0, f64::max)
}

impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            scene,
            object_curvature,
            indentation,
            polar_deg,
            thickness,
            misalignment,
            size_px,
            pixel_std,
            coverage95,
            mean_per_scatter,
            rms_per_bound,
            rms_per_pixel_bound,
            width_per_rms,
            closed,
            failures,
            doubted,
            doubts,
            small_p_values,
            ..
        } = self;
        let known = match self.fits_indentation {
            true => "fitted",
            false => "known",
        };
        let [rms_per_bound, rms_per_pixel_bound] =
            [rms_per_bound, rms_per_pixel_bound].map(|ratio| Number(*ratio));
        write!(
            f,
            "{}, {scene}: 1/R {object_curvature:.3}, {indentation:.2} mm deep ({known}), {polar_deg:.0} deg, layer \
             {thickness:.1}, discs {misalignment:.2}, {size_px} px, noise {pixel_std:.1}: {:.1} % covered, mean/scatter \
             {mean_per_scatter:.2}, rms/bound {rms_per_bound:.2} (pixels' {rms_per_pixel_bound:.2}), width \
             {width_per_rms:.2}, closed {:.0} % {failures}, p < {SMALL} in {:.0} %, doubted {:.0} % ({doubts})",
            self.family,
            100.0 * coverage95,
            100.0 * closed,
            100.0 * small_p_values,
            100.0 * doubted,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::case::Family;
    use super::super::summary::Summary;
    use super::*;
    use palpate_press::Estimated;

    fn judged(error: f64, high: Option<f64>) -> Judged {
        Ok(JudgedCurvature {
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
            doubts: Vec::new(),
        })
    }

    #[test]
    fn trials_are_summed_up() {
        let case = Case::random(Family::Sound, 1, 0);
        let trials = [
            judged(0.01, Some(0.12)),
            judged(-0.01, None),
            judged(0.03, Some(0.14)),
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
        let summary = Summary::of(Family::Sound, &[&score]).unwrap();
        assert!(!summary.is_within_limits());
        assert_eq!(Summary::of(Family::Sound, &[]), None);
    }

    #[test]
    fn all_scenes_count_alike() {
        let case = Case::random(Family::Sound, 1, 0);
        let trials: Vec<Judged> = (0..100)
            .map(|trial| {
                let error = if trial % 20 == 0 { 0.021 } else { 0.0088 };
                judged(if trial % 2 == 0 { error } else { -error }, Some(0.12))
            })
            .collect();
        let good = score(&case, &trials, Some(0.01));
        let summary = Summary::of(Family::Sound, &[&good, &good]).unwrap();
        assert!(summary.is_within_limits(), "{summary}");
        let bad = Score {
            coverage95: 0.5,
            ..good.clone()
        };
        let of = |family, one: &Score| Summary::of(family, &[one]).unwrap();
        assert!(!of(Family::Sound, &bad).is_within_limits());
        // A wrong model has to be doubted where its intervals do not hold.
        assert!(!of(Family::LayerForHalfSpace, &bad).is_within_limits());
        let doubted = Score {
            doubted: 0.9,
            ..bad
        };
        assert!(of(Family::LayerForHalfSpace, &doubted).is_within_limits());
        let doubted = Score {
            doubted: 0.06,
            ..good
        };
        assert!(!of(Family::Sound, &doubted).is_within_limits());
    }
}
