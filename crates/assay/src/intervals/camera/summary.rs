//! All scenes of a family together.

use std::fmt;

use palpate_statistics::Number;

use super::super::doubted::{Scene, Shares};
use super::super::sums::HOLDS;
use super::case::Family;
use super::score::Score;

/// Limits of the coverage of intervals of 95 % over all scenes.
const COVERAGE: [f64; 2] = [0.92, 0.97];
/// Least share of scenes in which they hold.
const SCENES: f64 = 0.95;
/// Largest mean error, in the errors' standard deviations.
const MEAN: f64 = 0.3;
/// Largest root mean square of the errors, in the Cramér–Rao bound.
const RMS: f64 = 1.3;
/// Largest mean width of closed intervals of 95 %, in what errors of this scatter would need.
const WIDTH: f64 = 1.5;

/// All scenes together.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The family.
    family: Family,
    /// Share of intervals of 95 % that hold the truth, over all scenes.
    pub coverage95: f64,
    /// Number of scenes.
    pub scenes: usize,
    /// Number of scenes in which intervals of 95 % hold in at least 85 %.
    pub holding: usize,
    /// Number of scenes whose mean error is at most 0.3 of the scatter.
    pub unbiased: usize,
    /// Root mean square over scenes of the errors in bounds.
    pub rms_per_bound: f64,
    /// Number of scenes in which that is at most 1.3.
    pub efficient: usize,
    /// Root mean square over scenes of the errors in the pixels' bounds.
    pub rms_per_pixel_bound: f64,
    /// Mean over scenes of the widths of closed intervals, in what errors of this scatter would need.
    pub width_per_rms: f64,
    /// Shares of intervals with two ends, one and none, and of failures.
    pub shares: [f64; 4],
    /// Share of fits whose p-value is below 0.05.
    pub small_p_values: f64,
    /// Doubts in scenes that hold and in others.
    pub doubted: Shares,
}

impl Summary {
    /// The summary of some scenes of a family; `None` of none.
    pub(super) fn of(family: Family, scores: &[&Score]) -> Option<Self> {
        if scores.is_empty() {
            return None;
        }
        // Scenes without an estimate have no errors.
        let mean = |part: &dyn Fn(&Score) -> f64| {
            let parts = scores.iter().map(|one| part(one));
            let parts: Vec<f64> = parts.filter(|part| !part.is_nan()).collect();
            parts.iter().sum::<f64>() / parts.len() as f64
        };
        let count = |is: &dyn Fn(&Score) -> bool| scores.iter().filter(|one| is(one)).count();
        Some(Self {
            family,
            coverage95: mean(&|one| one.coverage95),
            scenes: scores.len(),
            holding: count(&|one| one.coverage95 >= HOLDS),
            unbiased: count(&|one| one.mean_per_scatter.abs() <= MEAN),
            rms_per_bound: mean(&|one| one.rms_per_bound.powi(2)).sqrt(),
            efficient: count(&|one| one.rms_per_bound <= RMS),
            rms_per_pixel_bound: mean(&|one| one.rms_per_pixel_bound.powi(2)).sqrt(),
            width_per_rms: mean(&|one| one.width_per_rms),
            shares: [
                mean(&|one| one.closed),
                mean(&|one| one.one_sided),
                mean(&|one| one.open),
                mean(&|one| one.failed),
            ],
            small_p_values: mean(&|one| one.small_p_values),
            doubted: Shares::of(&scores.iter().map(told).collect::<Vec<Scene>>()),
        })
    }

    /// Whether all is within the limits.
    pub fn is_within_limits(&self) -> bool {
        if self.family.is_wrong() {
            return self.doubted.hold();
        }
        self.doubted.hold()
            && (COVERAGE[0]..=COVERAGE[1]).contains(&self.coverage95)
            && self.holding as f64 >= SCENES * self.scenes as f64
            && self.unbiased == self.scenes
            && self.rms_per_bound <= RMS
            && self.width_per_rms <= WIDTH
    }
}

/// Coverage of a scene's estimates, and how many of them are doubted.
fn told(score: &&Score) -> Scene {
    Scene {
        coverage: score.coverage95 / (1.0 - score.failed),
        doubted: score.doubted,
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            coverage95,
            scenes,
            holding,
            unbiased,
            rms_per_bound,
            efficient,
            rms_per_pixel_bound,
            width_per_rms,
            shares,
            family,
            small_p_values,
            doubted,
        } = self;
        let [closed, one_sided, open, failed] = shares.map(|share| 100.0 * share);
        let [rms_per_bound, rms_per_pixel_bound] =
            [rms_per_bound, rms_per_pixel_bound].map(|ratio| Number(*ratio));
        let limits = match self.is_within_limits() {
            true => "within the limits",
            false => "beyond the limits",
        };
        write!(
            f,
            "{}: {:.1} % covered over all; at least 85 % in {holding} of {scenes} scenes; mean error at most 0.3 of the \
             scatter in {unbiased}; rms/bound {rms_per_bound:.2}, at most 1.3 in {efficient} (pixels' bound \
             {rms_per_pixel_bound:.2}); width/(3.92 rms) {width_per_rms:.2}; closed {closed:.1} %, one-sided \
             {one_sided:.1} %, open {open:.1} %, failed {failed:.1} %; p < 0.05 in {:.1} %; {doubted}: {limits}",
            family.name(),
            100.0 * coverage95,
            100.0 * small_p_values,
        )
    }
}
