//! Sums of one quantity over consecutive trials.

use crate::moments::Moments;
use crate::simd_sums::{Observed, Totals, is_covered};
use crate::squares::TrialSquares;

/// Sums over the observations of one quantity in consecutive trials. All statistics of the quantity, except the
/// quantiles, are computed from these sums. To merge the sums of two consecutive ranges of trials, merge the later
/// range into the earlier one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sums {
    /// Smallest and largest true value.
    truths: [f64; 2],
    /// Smallest and largest error.
    range: [f64; 2],
    pub(crate) estimates: Moments,
    pub(crate) errors: Moments,
    magnitude: f64,
    pub(crate) squares: TrialSquares,
    /// Mean and standard deviation (moments), over the trials, of two numbers: the mean estimate of a trial (index 0),
    /// and the mean absolute error of a trial (index 1).
    pub(crate) by_trial: [Moments; 2],
    reported: u64,
    std: f64,
    intervals: u64,
    /// Number of observations whose 50, 80 and 95 % intervals contain the true value.
    covered: [u64; 3],
}

impl Sums {
    /// Sums over observations that are all from different trials. The errors of the observations are written to
    /// `errors`.
    pub(crate) fn of(observed: Observed<'_>, errors: &mut Vec<f64>) -> Self {
        let Some(totals) = Totals::of(observed, errors) else {
            return Self::default();
        };
        let count = errors.len() as f64;
        let estimates = Moments::with_sums(observed.estimates, totals.of_estimates);
        let moments = Moments::with_sums(errors, totals.of_errors);
        let magnitude = mean(errors[0].abs() + totals.of_magnitudes / count, || {
            errors.iter().map(|error| error.abs() / count).sum()
        });
        let reported = totals.reported as f64;
        let std = mean(totals.stds / reported.max(1.0), || {
            observed
                .stds
                .iter()
                .map(|std| std.max(0.0) / reported)
                .sum()
        });
        Self {
            truths: totals.truths,
            range: totals.errors,
            estimates,
            errors: moments,
            magnitude,
            squares: TrialSquares::of_each(errors, totals.of_squares),
            by_trial: [estimates, moments.of_magnitudes(magnitude)],
            reported: totals.reported,
            std,
            intervals: totals.reported,
            covered: totals.covered,
        }
    }

    /// Converts sums over observations that are all from a single trial. In standard errors, these observations then
    /// count as one trial instead of as independent observations.
    pub(crate) fn of_trial(self) -> Self {
        let means = [self.estimates.mean(), Some(self.magnitude)];
        Self {
            squares: TrialSquares::of_trial(self.errors.count(), self.errors.rms().unwrap_or(0.0)),
            by_trial: means.map(|mean| Moments::one(mean.unwrap_or(0.0))),
            ..self
        }
    }

    /// Replaces the coverage of an observation: whether its 50, 80 and 95 % intervals contain the true value. The
    /// previous coverage was computed from `error` and `std`; the trial itself reports `holds` instead.
    pub(crate) fn replace_coverage(&mut self, error: f64, std: f64, holds: [bool; 3]) {
        self.intervals += u64::from(std < 0.0);
        let verdicts = holds.into_iter().zip(is_covered(error, std));
        for (covered, (holds, would)) in self.covered.iter_mut().zip(verdicts) {
            *covered += u64::from(holds);
            *covered -= u64::from(would);
        }
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        let (count, more) = (self.errors.count(), other.errors.count());
        if more == 0 {
            return;
        }
        if count == 0 {
            *self = *other;
            return;
        }
        for (own, more) in [
            (&mut self.truths, other.truths),
            (&mut self.range, other.range),
        ] {
            *own = [own[0].min(more[0]), own[1].max(more[1])];
        }
        self.estimates.merge(&other.estimates);
        self.errors.merge(&other.errors);
        self.magnitude = toward(self.magnitude, other.magnitude, [count, more]);
        self.squares.merge(&other.squares);
        for (own, more) in self.by_trial.iter_mut().zip(&other.by_trial) {
            own.merge(more);
        }
        self.std = toward(self.std, other.std, [self.reported, other.reported]);
        self.reported += other.reported;
        self.intervals += other.intervals;
        for (own, more) in self.covered.iter_mut().zip(other.covered) {
            *own += more;
        }
    }

    /// The true value of the quantity; `None` if it differs between observations, or if there are no observations.
    pub(crate) fn truth(&self) -> Option<f64> {
        let [least, most] = self.truths;
        (self.errors.count() > 0 && least == most).then_some(least)
    }

    pub(crate) fn mean_magnitude(&self) -> Option<f64> {
        (self.errors.count() > 0).then_some(self.magnitude)
    }

    pub(crate) fn mean_std(&self) -> Option<f64> {
        (self.reported > 0).then_some(self.std)
    }

    /// Shares of the 50, 80 and 95 % intervals that contain the true value; `None` if no observation has an interval.
    pub(crate) fn coverages(&self) -> [Option<f64>; 3] {
        let share =
            |covered: u64| (self.intervals > 0).then(|| covered as f64 / self.intervals as f64);
        self.covered.map(share)
    }

    pub(crate) fn clamp(&self, error: f64) -> f64 {
        error.max(self.range[0]).min(self.range[1])
    }
}

/// Mean of some numbers. `plain` is their sum divided by their count. It is returned if it is finite. If it is not
/// finite because the sum overflowed, `of_shares` computes the mean: it divides each number by the count before it adds
/// them.
fn mean(plain: f64, of_shares: impl FnOnce() -> f64) -> f64 {
    match plain.is_finite() {
        true => plain,
        false => of_shares().min(f64::MAX),
    }
}

/// Mean of all values of two groups. `mean` is the mean of the `count` values of the first group, and `other` is the
/// mean of the `more` values of the second group. Neither `mean` nor `other` may be negative.
fn toward(mean: f64, other: f64, [count, more]: [u64; 2]) -> f64 {
    mean + (other - mean) * (more as f64 / (count + more).max(1) as f64)
}
