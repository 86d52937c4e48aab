//! Computes from the trials of a cell of the study how certainly the cell meets or misses the target. This certainty is
//! the score of the cell.

use crate::search::Scores;
use palpate_scene::Scene;
use palpate_study::{Bound, Quantity, QuantityKind, Statistic, Target};
use palpate_sweep::{
    Batches, CERTAIN, CellStatistics, Estimate, Summary, drop_undefined_moments, share_at_most,
};

/// If all trials of a cell of the study fail, the target's statistic does not exist. The cell misses the target if its
/// share of failed trials is significantly larger than this value.
const NO_ESTIMATE_SHARE: f64 = 0.5;
/// Rounding error of an estimated quantile, as a share of the distance between the quantile and the true value.
/// Quantiles are rounded because they are computed from a histogram.
const QUANTILE_RESOLUTION: f64 = 1.0 / 256.0;

/// The target of a question, for one scene: a limit on a statistic of one of the scene's quantities.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SceneTarget {
    target: Target,
    max_failures: f64,
    quantities: &'static [Quantity],
    place: usize,
}

/// Reason why the target's statistic is undefined although some trials succeed.
pub(crate) struct NoValue(pub(crate) &'static str);

impl SceneTarget {
    pub(crate) fn new(
        target: Target,
        max_failures: f64,
        quantities: &'static [Quantity],
    ) -> Option<Self> {
        let place = match target.quantity {
            None => 0,
            Some(quantity) => quantities.iter().position(|one| *one == quantity)?,
        };
        quantities.get(place)?;
        Some(Self {
            target,
            max_failures,
            quantities,
            place,
        })
    }

    pub(crate) fn quantity(&self) -> Quantity {
        self.quantities[self.place]
    }

    /// Empty batches of trials, whose first trial has the number `first`. They store only the quantities that the
    /// target needs.
    pub(crate) fn batches(&self, first: u64) -> Batches {
        let of = self.quantity().inverse_of(self.quantities);
        let stored = [self.place].into_iter().chain(of).collect();
        let is_quantile = matches!(
            self.target.statistic,
            Statistic::Q05 | Statistic::Q50 | Statistic::Q95
        );
        Batches::from_trial(first, Some((stored, is_quantile)))
    }

    fn estimate(&self, scene: &Scene, batches: &Batches) -> Option<Estimate> {
        let mut estimate = batches.estimate(|all| self.statistic(scene, all))?;
        let truth = batches.statistics().quantities[self.place].truth;
        if let (Statistic::Q05 | Statistic::Q50 | Statistic::Q95, Some(truth)) =
            (self.target.statistic, truth)
        {
            estimate.resolution = (estimate.value - truth).abs() * QUANTILE_RESOLUTION;
        }
        Some(estimate)
    }

    fn statistic(&self, scene: &Scene, all: &CellStatistics) -> Option<f64> {
        let mut summaries = all.quantities.clone();
        let quantities = self.quantities;
        drop_undefined_moments(&mut summaries, |place| {
            quantities[place].inverse_of(quantities)
        });
        match self.target.statistic {
            Statistic::StdBound => scene.std_bound(self.place),
            statistic => of_summary(summaries.get(self.place)?, statistic),
        }
    }

    /// The scores of two conditions: the limit on the target's statistic, and the limit on the share of failed trials.
    /// Also the statistic itself, if it is defined.
    pub(crate) fn scores(
        &self,
        scene: &Scene,
        batches: &Batches,
    ) -> Result<(Scores, Option<Estimate>), NoValue> {
        let all = batches.statistics();
        let (trials, failed) = (all.trials, all.failed());
        let of_failures = match scene.is_random() {
            _ if self.max_failures >= 1.0 => CERTAIN,
            true => share_at_most(failed, trials, self.max_failures),
            false if failed > 0 => -CERTAIN,
            false => CERTAIN,
        };
        if failed == trials {
            let of_statistic = match scene.is_random() {
                true => share_at_most(failed, trials, NO_ESTIMATE_SHARE),
                false => -CERTAIN,
            };
            return Ok(([of_statistic, of_failures], None));
        }
        let estimate = self.estimate(scene, batches);
        let of_statistic = match &estimate {
            Some(estimate) => self.score(estimate, trials - failed),
            None => match self.why_undefined(&all) {
                Some(why) => return Err(NoValue(why)),
                None => 0.0,
            },
        };
        Ok(([of_statistic, of_failures], estimate))
    }

    /// Reason why the target's statistic is undefined, however many trials are run. `None` if more trials may give a
    /// value.
    fn why_undefined(&self, all: &CellStatistics) -> Option<&'static str> {
        let summary = &all.quantities[self.place];
        let is_relative = matches!(
            self.target.statistic,
            Statistic::RelativeRmsError | Statistic::RelativeMeanAbsError
        );
        match self.target.statistic {
            _ if summary.observations == 0 => Some("no trial has a value of this quantity"),
            _ if is_relative && summary.truth == Some(0.0) => {
                Some("the true value is 0; use rms_error or mean_abs_error")
            }
            _ if is_relative && summary.truth.is_none() => {
                Some("the true value differs from point to point; use rms_error or mean_abs_error")
            }
            Statistic::Q05 | Statistic::Q50 | Statistic::Q95 if summary.truth.is_none() => {
                Some("the true value differs from point to point")
            }
            statistic if statistic == Statistic::MeanReportedStd || statistic.is_coverage() => {
                Some("the estimator states no standard deviation")
            }
            Statistic::StdBound => Some("there is no bound; only presses with noise have a bound"),
            _ if self.quantity().inverse_of(self.quantities).is_some() => {
                Some("its sign is undecided; use a quantile, or the curvature")
            }
            _ => None,
        }
    }

    /// Score of an estimated statistic: its distance from the limit of the target, in standard errors. `successes` is
    /// the number of successful trials.
    fn score(&self, estimate: &Estimate, successes: u64) -> f64 {
        let (bound, limit) = (self.target.bound, self.target.limit);
        let statistic = self.target.statistic;
        let of = |estimate: &Estimate, limit: f64| match bound {
            Bound::AtMost => estimate.score(limit, 1.0),
            Bound::AtLeast => estimate.score(limit, -1.0),
        };
        // Rms errors, mean absolute errors and standard deviations are positive. The distribution of their logarithms
        // is closer to a normal distribution than their own distribution. Therefore, compare the logarithm of the
        // statistic with the logarithm of the limit.
        let logs = match statistic.is_size() && limit > 0.0 {
            true => estimate.map(libm::log),
            false => None,
        };
        let score = logs.map_or_else(|| of(estimate, limit), |logs| of(&logs, libm::log(limit)));
        let is_share = statistic.is_coverage()
            || statistic == Statistic::Mean && self.quantity().kind == QuantityKind::Share;
        if !(is_share && limit > 0.0 && limit < 1.0) {
            return score;
        }
        // A share, such as a coverage, may be equal in all batches of trials. The standard error is estimated from the
        // scatter between batches, so it is then 0, although the true share may differ. Therefore, compute a second
        // score from the number of trials, and use the score with the smaller absolute value.
        let (share, limit) = match bound {
            Bound::AtMost => (estimate.value, limit),
            Bound::AtLeast => (1.0 - estimate.value, 1.0 - limit),
        };
        let count = (share * successes as f64).round() as u64;
        let as_share = share_at_most(count, successes, limit);
        match score * as_share > 0.0 {
            true if score.abs() < as_share.abs() => score,
            true => as_share,
            false => 0.0,
        }
    }
}

/// The statistic `statistic` in the summary of a quantity's trials.
fn of_summary(summary: &Summary, statistic: Statistic) -> Option<f64> {
    match statistic {
        Statistic::Mean => summary.mean,
        Statistic::Std => summary.std,
        Statistic::Bias => summary.bias,
        Statistic::RmsError => summary.rms_error,
        Statistic::RmsErrorStd => summary.rms_error_std,
        Statistic::MeanAbsError => summary.mean_abs_error,
        Statistic::RelativeRmsError => summary.relative_rms_error,
        Statistic::RelativeMeanAbsError => summary.relative_mean_abs_error,
        Statistic::Q05 => summary.q05,
        Statistic::Q50 => summary.q50,
        Statistic::Q95 => summary.q95,
        Statistic::MeanReportedStd => summary.mean_reported_std,
        Statistic::Coverage50 => summary.coverage50,
        Statistic::Coverage80 => summary.coverage80,
        Statistic::Coverage95 => summary.coverage95,
        // These statistics cannot be targets, because they do not depend on the trials or do not describe the
        // estimates.
        Statistic::Truth | Statistic::Trials | Statistic::Failures | Statistic::StdBound => None,
    }
}
