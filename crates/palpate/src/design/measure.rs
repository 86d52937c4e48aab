//! How surely the trials of a cell keep the limit of a target.

use palpate_scene::Scene;
use palpate_study::{Bound, Quantity, QuantityKind, Statistic, Target};
use palpate_sweep::{Batches, CERTAIN, CellStatistics, Estimate, Scores, Summary, share_at_most};

use crate::means;

/// Share of successes below which there is no estimate to speak of.
const HARDLY_ANY: f64 = 0.5;
/// Parts of the distance to the truth to which a quantile is known.
const QUANTILE_PARTS: f64 = 256.0;

/// Target in a scene: a statistic of one of its quantities.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measure {
    pub(crate) target: Target,
    pub(crate) max_failures: f64,
    quantities: &'static [Quantity],
    /// Place of the target's quantity among those of the scene.
    place: usize,
}

/// Statistic that has no value although trials succeed, and why.
pub(crate) struct NoValue(pub(crate) &'static str);

impl Measure {
    /// Target in a scene with these quantities; `None` where it has not the quantity of the target.
    pub(crate) fn of(
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

    /// No trials yet, of which as much is kept as the target needs.
    pub(crate) fn batches(&self, first: u64) -> Batches {
        let of = self.quantity().inverse_of();
        let of = of.and_then(|of| self.quantities.iter().position(|one| *one == of));
        let kept = [self.place].into_iter().chain(of).collect();
        let is_quantile = matches!(
            self.target.statistic,
            Statistic::Q05 | Statistic::Q50 | Statistic::Q95
        );
        Batches::from_trial(first).keeping(kept, is_quantile)
    }

    /// The statistic with its standard error; `None` where it is undefined.
    fn estimate(&self, scene: &Scene, batches: &Batches) -> Option<Estimate> {
        let estimate = batches.estimate(|all| self.statistic(scene, all))?;
        let truth = batches.statistics().quantities[self.place].truth;
        Some(match (self.target.statistic, truth) {
            (Statistic::Q05 | Statistic::Q50 | Statistic::Q95, Some(truth)) => {
                let distance = (estimate.value - truth).abs();
                estimate.with_resolution(distance / QUANTILE_PARTS)
            }
            _ => estimate,
        })
    }

    fn statistic(&self, scene: &Scene, all: &CellStatistics) -> Option<f64> {
        let mut summaries = all.quantities.clone();
        if self.quantity().inverse_of().is_some() {
            means::withhold(self.quantities, &mut summaries);
        }
        match self.target.statistic {
            Statistic::StdBound => scene.std_bound(self.place),
            statistic => of_summary(summaries.get(self.place)?, statistic),
        }
    }

    /// Scores of the statistic and of the share of failures, and the statistic where it is defined.
    pub(crate) fn judge(
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
                true => share_at_most(failed, trials, HARDLY_ANY),
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

    /// Reason for which the statistic has no value whatever the number of trials; `None` where more may give one.
    fn why_undefined(&self, all: &CellStatistics) -> Option<&'static str> {
        let summary = &all.quantities[self.place];
        let is_relative = matches!(
            self.target.statistic,
            Statistic::RelativeRmsError | Statistic::RelativeMeanAbsError
        );
        match self.target.statistic {
            _ if summary.observations == 0 => None,
            _ if is_relative && summary.truth == Some(0.0) => {
                Some("the true value is 0; take rms_error or mean_abs_error")
            }
            _ if is_relative && summary.truth.is_none() => {
                Some("the true value differs from place to place; take rms_error or mean_abs_error")
            }
            Statistic::Q05 | Statistic::Q50 | Statistic::Q95 if summary.truth.is_none() => {
                Some("the true value differs from place to place")
            }
            statistic if statistic == Statistic::MeanReportedStd || statistic.is_coverage() => {
                Some("the estimator states no standard deviation")
            }
            Statistic::StdBound => Some("there is no bound; only presses with noise have one"),
            _ if self.quantity().inverse_of().is_some() => {
                Some("its sign is undecided; take a quantile, or the curvature")
            }
            _ => None,
        }
    }

    /// Score by which a statistic keeps the limit, after so many trials that succeeded.
    fn score(&self, estimate: &Estimate, successes: u64) -> f64 {
        let Target {
            statistic,
            bound,
            limit,
            ..
        } = self.target;
        let of = |estimate: &Estimate, limit: f64| match bound {
            Bound::AtMost => estimate.at_most(limit),
            Bound::AtLeast => estimate.at_least(limit),
        };
        // The size of an error is nearer to normal on a log scale.
        let logs = match statistic.is_size() && limit > 0.0 {
            true => estimate.map(libm::log),
            false => None,
        };
        let score = match logs {
            Some(logs) => of(&logs, libm::log(limit)),
            None => of(estimate, limit),
        };
        let is_share = statistic.is_coverage()
            || statistic == Statistic::Mean && self.quantity().kind == QuantityKind::Share;
        if !(is_share && limit > 0.0 && limit < 1.0) {
            return score;
        }
        // A share that no batch differs in may still not be 1.
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

/// Value of a statistic of a quantity's trials.
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
        // Known without trials, or no statistic of estimates.
        Statistic::Truth | Statistic::Trials | Statistic::Failures | Statistic::StdBound => None,
    }
}
