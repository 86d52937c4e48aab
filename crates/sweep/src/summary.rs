//! Statistics and failures of a cell.

use crate::histogram::Histogram;
use crate::sums::Sums;

/// Statistics and failures of all trials of a cell.
///
/// ```
/// use palpate_sweep::{Cell, Failure, Record, RunOptions, Runner, Trial};
///
/// struct EveryThirdSlips;
/// impl Trial for EveryThirdSlips {
///     fn quantities(&self) -> usize { 0 }
///     fn run(&self, trial: u64, _record: &mut Record) -> Result<(), &'static str> {
///         if trial % 3 == 2 { Err("slipped") } else { Ok(()) }
///     }
/// }
/// let runner = Runner::new(&RunOptions::default())?;
/// let statistics = runner.run(&[Cell { trials: 9, trial: &EveryThirdSlips }], &|_| ());
/// assert_eq!((statistics[0].trials, statistics[0].failed()), (9, 3));
/// assert_eq!(statistics[0].failures, [Failure { kind: "slipped", count: 3, first_trial: 2 }]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CellStatistics {
    /// Number of trials that were run, including failed trials.
    pub trials: u64,
    /// Failures, with one entry per kind, in the alphabetical order of the kinds.
    pub failures: Vec<Failure>,
    /// Statistics of each quantity, in the order of the quantities' indices in the trials.
    pub quantities: Vec<Summary>,
}

impl CellStatistics {
    /// Number of failed trials.
    pub fn failed(&self) -> u64 {
        self.failures.iter().map(|failure| failure.count).sum()
    }
}

/// Statistics of one quantity over the observations of the trials that succeeded.
///
/// An error is the estimate minus the true value. Every number is finite, and is either in the quantity's unit or a
/// ratio. A statistic is `None` if it is undefined or too large for `f64`. Without observations, all statistics are
/// undefined. The rounding error of means, rms values and standard deviations is at most 1e-13 of the mean absolute
/// value of the estimates or errors from which they are computed, for numbers of any size. For standard deviations, the
/// rounding error is also at most 1e-12 of the result. Results below 1e-308 have fewer significant digits, because such
/// doubles are small multiples of the smallest positive double.
///
/// ```
/// use palpate_sweep::{Cell, Observation, Record, RunOptions, Runner, Trial};
///
/// struct Swing;
/// impl Trial for Swing {
///     fn quantities(&self) -> usize { 1 }
///     fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
///         let estimate = if trial % 2 == 0 { 1.0 } else { 3.0 };
///         record.observe(0, Observation { estimate, truth: 2.0, std: None, interval_holds: None });
///         Ok(())
///     }
/// }
/// let runner = Runner::new(&RunOptions::default())?;
/// let swing = runner.run(&[Cell { trials: 4, trial: &Swing }], &|_| ())[0].quantities[0];
/// assert_eq!((swing.mean, swing.bias, swing.rms_error), (Some(2.0), Some(0.0), Some(1.0)));
/// assert_eq!((swing.relative_rms_error, swing.coverage95), (Some(0.5), None));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Number of observations of the quantity in all successful trials.
    pub observations: u64,
    /// The true value of the quantity; `None` if it differs between observations.
    pub truth: Option<f64>,
    /// Mean of the estimates; `None` if it is undefined.
    pub mean: Option<f64>,
    /// Sample standard deviation of the estimates, with the divisor n − 1; `None` for fewer than two estimates.
    pub std: Option<f64>,
    /// Mean of the errors (estimate minus true value); `None` if it is undefined.
    pub bias: Option<f64>,
    /// Root mean square of the errors (estimate minus true value); `None` if it is undefined.
    pub rms_error: Option<f64>,
    /// Standard error of `rms_error`, to first order; `None` for fewer than two trials. It is computed from the scatter
    /// of the squared errors between trials, so the observations within one trial count as a single observation.
    pub rms_error_std: Option<f64>,
    /// Mean of the absolute errors (|estimate minus true value|); `None` if it is undefined.
    pub mean_abs_error: Option<f64>,
    /// `rms_error` divided by the absolute true value; `None` if the true value is 0 or differs between observations.
    pub relative_rms_error: Option<f64>,
    /// `mean_abs_error` divided by the absolute true value; `None` if the true value is 0 or differs between
    /// observations.
    pub relative_mean_abs_error: Option<f64>,
    /// 5 % quantile of the estimates; `None` if the true value differs between observations. The quantile is computed
    /// from a histogram, so it has an error of at most 0.4 % of its difference from the true value.
    ///
    /// Quantiles are interpolated linearly between the sorted estimates (type 7, the usual definition).
    pub q05: Option<f64>,
    /// Median of the estimates. It has the same accuracy as `q05`, and is `None` in the same cases.
    pub q50: Option<f64>,
    /// 95 % quantile of the estimates. It has the same accuracy as `q05`, and is `None` in the same cases.
    pub q95: Option<f64>,
    /// Mean of the standard deviations that the trials reported; `None` if they reported none.
    pub mean_reported_std: Option<f64>,
    /// Share of the 50 % intervals that contain the true value. An interval is the estimate ± 0.67 standard deviations,
    /// unless the trial reports itself whether its interval contains the true value (`interval_holds`). `None` if the
    /// trials reported no standard deviation and no coverage.
    pub coverage50: Option<f64>,
    /// Share of the 80 % intervals that contain the true value; `None` in the same cases as `coverage50`. An interval
    /// is the estimate ± 1.28 standard deviations, unless the trial reports its own coverage.
    pub coverage80: Option<f64>,
    /// Share of the 95 % intervals that contain the true value; `None` in the same cases as `coverage50`. An interval
    /// is the estimate ± 1.96 standard deviations, unless the trial reports its own coverage.
    pub coverage95: Option<f64>,
}

impl Summary {
    pub(crate) fn new(sums: &Sums, histogram: &Histogram) -> Self {
        let truth = sums.truth();
        let relative = |error: Option<f64>| {
            let truth = truth.filter(|&truth| truth != 0.0)?;
            finite(Some(error? / truth.abs()))
        };
        let quantiles = truth.and_then(|_| histogram.quantiles([0.05, 0.50, 0.95]));
        let quantile = |place: usize| finite(Some(truth? + sums.clamp(quantiles?[place])));
        let rms_error = finite(sums.errors.rms());
        let mean_abs_error = finite(sums.mean_magnitude());
        let [coverage50, coverage80, coverage95] = sums.coverages();
        Self {
            observations: sums.errors.count(),
            truth,
            mean: finite(sums.estimates.mean()),
            std: finite(sums.estimates.std()),
            bias: finite(sums.errors.mean()),
            rms_error,
            rms_error_std: finite(sums.squares.std_of_rms()),
            mean_abs_error,
            relative_rms_error: relative(rms_error),
            relative_mean_abs_error: relative(mean_abs_error),
            q05: quantile(0),
            q50: quantile(1),
            q95: quantile(2),
            mean_reported_std: finite(sums.mean_std()),
            coverage50,
            coverage80,
            coverage95,
        }
    }
}

/// The mean and the standard deviation of an inverse quantity, such as a radius, are reported only if the inverted
/// quantity, here the curvature, is at least this many standard deviations away from 0. At most one of 30,000 Gaussian
/// estimates then has the wrong sign.
const MIN_DEVIATIONS: f64 = 4.0;

/// Removes means and standard deviations of inverse quantities, such as radii, if the trials do not determine the sign
/// of the inverted quantity. For each index of a quantity, `inverse_of` returns the index of the inverted quantity;
/// `None` if the quantity is not an inverse. The inverse of a Gaussian number has no mean and no standard deviation: a
/// mean over trials would depend on the few trials in which the inverted quantity is nearest to 0. Quantiles of inverse
/// quantities are kept, because they are defined.
pub fn drop_undefined_moments(
    summaries: &mut [Summary],
    inverse_of: impl Fn(usize) -> Option<usize>,
) {
    for place in 0..summaries.len() {
        let Some(inverted) = inverse_of(place) else {
            continue;
        };
        let Summary { mean, std, .. } = summaries[inverted];
        let std = std.unwrap_or(0.0);
        if mean.is_some_and(|mean| mean.abs() >= MIN_DEVIATIONS * std) {
            continue;
        }
        summaries[place] = Summary {
            mean: None,
            std: None,
            bias: None,
            rms_error: None,
            rms_error_std: None,
            mean_abs_error: None,
            relative_rms_error: None,
            relative_mean_abs_error: None,
            mean_reported_std: None,
            ..summaries[place]
        };
    }
}

fn finite(value: Option<f64>) -> Option<f64> {
    value.filter(|value| value.is_finite())
}

/// Kind of failure of a trial that recorded a number that is NaN or infinite: an estimate, a true value, an error or a
/// standard deviation.
pub(crate) const NOT_FINITE: &str = "not-finite";
pub(crate) const NEGATIVE_STD: &str = "negative-std";
pub(crate) const UNKNOWN_QUANTITY: &str = "unknown-quantity";

/// One kind of failure in a cell: how many trials failed in this way, and which of them was the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Name of the kind of failure. The name is stable and in kebab case.
    pub kind: &'static str,
    /// Number of trials with a failure of this kind.
    pub count: u64,
    /// Number of the first trial with a failure of this kind.
    pub first_trial: u64,
}

/// Failures of a cell, with one entry per kind. The entries are not sorted until [`Failures::sorted`] is called.
#[derive(Clone, Debug, Default)]
pub(crate) struct Failures(Vec<Failure>);

impl Failures {
    pub(crate) fn add(&mut self, failure: Failure) {
        match self.0.iter_mut().find(|known| known.kind == failure.kind) {
            Some(known) => {
                known.count += failure.count;
                known.first_trial = known.first_trial.min(failure.first_trial);
            }
            None => self.0.push(failure),
        }
    }

    pub(crate) fn merge(&mut self, other: Failures) {
        other.0.into_iter().for_each(|failure| self.add(failure));
    }

    pub(crate) fn sorted(mut self) -> Vec<Failure> {
        self.0.sort_by_key(|failure| failure.kind);
        self.0
    }
}
