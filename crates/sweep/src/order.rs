//! Estimates the probability that the results of two experiments are in the right order, that is, in the order of their
//! true values. The results are estimates of single trials, or means over several trials.

use std::ops::Range;

use rayon::prelude::*;

use palpate_statistics::score_of_tail;

use crate::cell::Trial;
use crate::certainty::wilson;
use crate::moments::Moments;
use crate::runner::Runner;
use crate::summary::NOT_FINITE;
use crate::trial_record::{Record, TrialObservations};

/// Mean estimate and mean true value of a quantity in one trial, over all observations of the trial. `Err` contains the
/// kind of failure if the trial failed.
pub type TrialMeans = Result<(f64, f64), &'static str>;

/// Estimated probability that the results of two experiments are in the order of their true values, with its 95 %
/// interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// Estimated probability that the results are in the order of the true values.
    pub probability: f64,
    /// Lower end of the probability's 95 % interval.
    pub low: f64,
    /// Upper end of the probability's 95 % interval.
    pub high: f64,
}

/// Number of trials that must be averaged, so that the means of two experiments are in the order of their true values
/// with the required probability.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeats {
    /// The number of trials that must be averaged, estimated from the means of groups of trials.
    Found(u64),
    /// An approximate number of trials. Too few trials were run to form enough groups of this size, so the number is
    /// computed as if the means were normally distributed.
    About(u64),
    /// No number of averaged trials gives the required probability: the means over all trials are in the wrong order,
    /// all estimates are equal, or no trial succeeded.
    Never,
    /// The number of trials to average cannot be estimated from the trials that were run, because they are too few.
    Unknown,
}

/// The means of groups of several trials are used only if at least this number of groups can be formed.
const GROUPS: usize = 256;
/// Defines the weight of an estimated variance in [`interval`]. The weight is u/(u + this number), where u
/// (`uncertain`) is a number of trials: the more trials support the variance, the larger are u and the weight. At u
/// equal to this number, the weight is one half.
const HALF_WEIGHT: f64 = 20.0;
/// Largest number of trials to average that [`repeats`] returns. A larger number is reported as unknown.
const MOST_REPEATS: f64 = 1e9;

impl Runner {
    /// Runs the trials `numbers` of an experiment, and returns the mean of a quantity in each trial. If the experiment
    /// is not random, only one trial is run.
    ///
    /// ```
    /// use palpate_sweep::{Observation, Record, RunOptions, Runner, Trial, in_order};
    ///
    /// /// Estimates its truth with an error of ±1.
    /// struct Coin(f64);
    /// impl Trial for Coin {
    ///     fn quantities(&self) -> usize { 1 }
    ///     fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
    ///         let estimate = self.0 + if trial % 2 == 0 { 1.0 } else { -1.0 };
    ///         record.observe(0, Observation { estimate, truth: self.0, std: None, interval_holds: None });
    ///         Ok(())
    ///     }
    /// }
    /// let runner = Runner::new(&RunOptions::default())?;
    /// let [low, high] = [Coin(5.0), Coin(6.0)].map(|coin| runner.trial_means(&coin, 0, 0..1000));
    /// assert_eq!(low[0], Ok((6.0, 5.0)));
    /// // 4 and 6 against 5 and 7: three of four pairs are in the right order.
    /// assert_eq!(in_order(&low, &high, None).probability, 0.75);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn trial_means<T: Trial + ?Sized>(
        &self,
        trial: &T,
        quantity: usize,
        numbers: Range<u64>,
    ) -> Vec<TrialMeans> {
        let count = numbers.end.saturating_sub(numbers.start);
        let count = if trial.is_random() {
            count
        } else {
            count.min(1)
        };
        let run = |record: &mut Record, place: u64| {
            let read = |observed: &TrialObservations<'_>| mean(observed, quantity);
            record.single_trial(&trial, numbers.start + place, read)?
        };
        self.install(|| {
            let places = (0..count as usize).into_par_iter();
            places
                .map_init(Record::default, |record, place| run(record, place as u64))
                .collect()
        })
    }
}

/// Mean estimate and mean true value of a quantity in a trial. If there are no observations, or if a mean is not
/// finite, returns the failure [`NOT_FINITE`].
fn mean(trial: &TrialObservations<'_>, quantity: usize) -> TrialMeans {
    let count = trial.of(quantity).count() as f64;
    let (mut estimate, mut truth) = (0.0, 0.0);
    for observation in trial.of(quantity) {
        estimate += observation.estimate / count;
        truth += observation.truth / count;
    }
    let is_finite = count > 0.0 && estimate.is_finite() && truth.is_finite();
    is_finite.then_some((estimate, truth)).ok_or(NOT_FINITE)
}

/// Probability that an estimate of experiment `low` is below an estimate of experiment `high`, over all pairs of
/// trials. The two experiments must have drawn different random numbers. A pair with equal estimates counts as half a
/// pair in the right order. So the probability is one half if the experiments cannot be distinguished. A pair with a
/// failed trial counts as in the wrong order. If `limit` is given, the result is the probability that both estimates
/// are above `limit`, for example that both experiments classify more than half of the points correctly.
///
/// The probability is Mann and Whitney's statistic, and its variance is computed by the formula of Sen (1960). The 95 %
/// interval is Wilson's interval. Its number of trials is the number of independent trials for which the estimated
/// probability would have this variance.
pub fn in_order(low: &[TrialMeans], high: &[TrialMeans], limit: Option<f64>) -> Order {
    order_of(&estimates(low), &estimates(high), limit)
}

fn order_of(one: &[Option<f64>], other: &[Option<f64>], limit: Option<f64>) -> Order {
    match limit {
        None => order(one, other),
        Some(limit) => above(one, other, limit),
    }
}

/// Number of trials of each experiment that must be averaged, so that the means of both experiments are in the right
/// order with the probability `confidence`. If `limit` is given, both means must be above this limit instead. Failed
/// trials are left out of the means.
pub fn repeats(
    one: &[TrialMeans],
    other: &[TrialMeans],
    limit: Option<f64>,
    confidence: f64,
) -> Repeats {
    let (one, other) = (estimates(one), estimates(other));
    let probability = |each: usize| {
        let (one, other) = (means(&one, each), means(&other, each));
        order_of(&one, &other, limit).probability
    };
    if probability(1) >= confidence {
        return Repeats::Found(1);
    }
    let most = one.len().min(other.len()) / GROUPS;
    // Double the number of trials until it is large enough for the required probability. Then find the smallest
    // sufficient number by bisection.
    let mut enough = 2;
    while enough <= most && probability(enough) < confidence {
        enough *= 2;
    }
    if enough <= most {
        let (mut few, mut enough) = (enough / 2, enough);
        while enough - few > 1 {
            let middle = few + (enough - few) / 2;
            if probability(middle) >= confidence {
                enough = middle;
            } else {
                few = middle;
            }
        }
        return Repeats::Found(enough as u64);
    }
    beyond(&one, &other, limit, confidence, most)
}

/// Number of trials to average, if it is larger than `most`, the largest number for which enough groups of trials can
/// be formed. The number is computed as if the means were normally distributed.
fn beyond(
    one: &[Option<f64>],
    other: &[Option<f64>],
    limit: Option<f64>,
    confidence: f64,
    most: usize,
) -> Repeats {
    let (Some(one), Some(other)) = (Spread::of(one), Spread::of(other)) else {
        return Repeats::Never;
    };
    // Each entry contains a distance that is computed from means over all trials, the standard deviation of this
    // distance for single trials, and its standard error for all trials. Without a limit, it is the distance between
    // the two means; with a limit, there is one entry for each mean, with its distance from the limit. The distance is
    // positive if the order is right.
    let separations = match limit {
        None => vec![(
            other.mean - one.mean,
            libm::hypot(one.std, other.std),
            libm::hypot(one.error, other.error),
        )],
        Some(limit) => [one, other]
            .map(|each| (each.mean - limit, each.std, each.error))
            .to_vec(),
    };
    let tail = match limit {
        None => 1.0 - confidence,
        // The means of both experiments must be above the limit, and they are independent. Therefore, the probability
        // for each mean alone must be the square root of the required probability.
        Some(_) => 1.0 - confidence.max(0.0).sqrt(),
    };
    let score = score_of_tail(tail);
    let mut needed: f64 = (most + 1) as f64;
    for (distance, spread, error) in separations {
        if distance < -2.0 * error || spread == 0.0 && distance <= 0.0 {
            return Repeats::Never;
        }
        if distance <= 2.0 * error {
            return Repeats::Unknown;
        }
        let ratio = score * spread / distance;
        needed = needed.max(ratio * ratio);
    }
    let success = one.success.min(other.success);
    let needed = (needed / success).ceil();
    match needed <= MOST_REPEATS {
        true => Repeats::About(needed as u64),
        false => Repeats::Unknown,
    }
}

#[derive(Clone, Copy)]
struct Spread {
    mean: f64,
    std: f64,
    error: f64,
    /// Share of the experiment's trials that succeeded, from 0 to 1.
    success: f64,
}

impl Spread {
    fn of(estimates: &[Option<f64>]) -> Option<Self> {
        let succeeded: Vec<f64> = estimates.iter().flatten().copied().collect();
        let moments = Moments::of(&succeeded);
        let (std, count) = (moments.std().unwrap_or(0.0), succeeded.len() as f64);
        Some(Self {
            mean: moments.mean()?,
            std,
            error: std / count.sqrt(),
            success: count / estimates.len() as f64,
        })
    }
}

fn estimates(means: &[TrialMeans]) -> Vec<Option<f64>> {
    means
        .iter()
        .map(|means| means.ok().map(|(estimate, _)| estimate))
        .collect()
}

/// Mean estimate of each group of `each` consecutive trials. Failed trials are left out of the means; `None` if all
/// trials of a group failed.
fn means(values: &[Option<f64>], each: usize) -> Vec<Option<f64>> {
    // An experiment that is not random has only one trial, which is also the mean of any group.
    if each == 1 || values.len() == 1 {
        return values.to_vec();
    }
    let mean = |group: &[Option<f64>]| {
        let count = group.iter().flatten().count() as f64;
        let mean = group
            .iter()
            .flatten()
            .map(|value| value / count)
            .sum::<f64>();
        (count > 0.0).then_some(mean)
    };
    values.chunks_exact(each).map(mean).collect()
}

fn sorted(values: &[Option<f64>]) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.iter().flatten().copied().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
}

fn order(low: &[Option<f64>], high: &[Option<f64>]) -> Order {
    let (sorted_low, sorted_high) = (sorted(low), sorted(high));
    // `sorted` contains the estimates of the successful trials of one experiment, and `value` is an estimate of the
    // other experiment. Returns the number of estimates in `sorted` that are below `value`, and the number of all
    // estimates in it. An estimate equal to `value` counts one half.
    let half_and_above = |sorted: &[f64], value: f64| {
        let [below, up_to] = [
            sorted.partition_point(|other| *other < value),
            sorted.partition_point(|other| *other <= value),
        ];
        (0.5 * (below + up_to) as f64, sorted.len() as f64)
    };
    let of_low = low.iter().map(|estimate| {
        estimate.map_or(0.0, |value| {
            let (below, all) = half_and_above(&sorted_high, value);
            (all - below) / high.len() as f64
        })
    });
    let of_high = high.iter().map(|estimate| {
        estimate.map_or(0.0, |value| {
            half_and_above(&sorted_low, value).0 / low.len() as f64
        })
    });
    let all = || of_low.clone().chain(of_high.clone());
    let below_one = all().filter(|share| *share < 1.0).count();
    let above_zero = all().filter(|share| *share > 0.0).count();
    let (mean, of_low) = mean_and_variance(of_low);
    let (_, of_high) = mean_and_variance(of_high);
    interval(
        mean,
        of_low + of_high,
        below_one.min(above_zero),
        [low.len(), high.len()],
    )
}

fn above(one: &[Option<f64>], other: &[Option<f64>], limit: f64) -> Order {
    let is_above =
        |estimate: &Option<f64>| estimate.map_or(0.0, |value| f64::from(u8::from(value > limit)));
    let all = || one.iter().chain(other).map(is_above);
    let below_one = all().filter(|share| *share < 1.0).count();
    let above_zero = all().filter(|share| *share > 0.0).count();
    let (one_share, one_variance) = mean_and_variance(one.iter().map(is_above));
    let (other_share, other_variance) = mean_and_variance(other.iter().map(is_above));
    let variance =
        other_share * other_share * one_variance + one_share * one_share * other_variance;
    let counts = [one.len(), other.len()];
    interval(
        one_share * other_share,
        variance,
        below_one.min(above_zero),
        counts,
    )
}

/// Mean of some numbers, and the squared standard error (variance) of this mean. For a single number, the variance is
/// 0, because an experiment with a single trial is not random.
fn mean_and_variance(numbers: impl ExactSizeIterator<Item = f64> + Clone) -> (f64, f64) {
    let count = numbers.len() as f64;
    let mean = numbers.clone().sum::<f64>() / count;
    let squares: f64 = numbers
        .map(|number| (number - mean) * (number - mean))
        .sum();
    match count > 1.0 {
        true => (mean, squares / (count - 1.0) / count),
        false => (mean, 0.0),
    }
}

/// Computes the 95 % interval of a probability from its variance and from the numbers of trials of the two experiments.
/// Every trial of one experiment forms a pair with every trial of the other. `uncertain` is the smaller of two numbers
/// of trials: trials with at least one pair in the right order, and trials with at least one pair in the wrong order.
/// If `uncertain` is small, the variance is inaccurate.
fn interval(probability: f64, variance: f64, uncertain: usize, [one, other]: [usize; 2]) -> Order {
    let order = |probability: f64, (low, high): (f64, f64)| Order {
        probability,
        low,
        high,
    };
    if one == 0 || other == 0 || !probability.is_finite() {
        return order(0.0, (0.0, 1.0));
    }
    // Neither experiment is random, so the probability is exact.
    if one == 1 && other == 1 {
        return order(probability, (probability, probability));
    }
    // `as_many` is the number of independent trials for which the estimated probability would have the variance
    // `variance`. It is at least `fewest`, the number of trials of the random experiment with fewer trials. If
    // `uncertain` is small, the variance is inaccurate, so it gets a small weight, and `as_many` stays near `fewest`.
    let fewest = match (one, other) {
        (1, random) | (random, 1) => random,
        (one, other) => one.min(other),
    } as f64;
    let as_many = probability * (1.0 - probability) / variance;
    let trusted = uncertain as f64 / (uncertain as f64 + HALF_WEIGHT);
    let more = Some(as_many - fewest).filter(|more| more.is_finite());
    let more = more.map_or(0.0, |more| more.max(0.0));
    let as_many = fewest + trusted * more;
    order(probability, wilson(probability, as_many))
}
