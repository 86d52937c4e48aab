//! How surely single trials, and means of several, tell two experiments apart.

use std::ops::Range;

use rayon::prelude::*;

use palpate_statistics::score_of_tail;

use crate::certainty::wilson;
use crate::record::{Record, TrialObservations};
use crate::runner::Runner;
use crate::trial::Trial;

/// Report of a trial on a quantity: its mean estimate and mean truth over the observations; `None` of a trial that failed.
pub type Told = Option<(f64, f64)>;

/// Probability, with a 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// The probability as it was found.
    pub probability: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end of its interval.
    pub high: f64,
}

/// Number of trials, the mean of which tells two experiments apart with a given probability.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeats {
    /// Found in groups of so many trials.
    Found(u64),
    /// Too many for groups; by the normal distribution that the means of many trials have.
    About(u64),
    /// None: the means of ever more trials are in the wrong order, or always tell the same.
    Never,
    /// Not known: so many would be needed that the trials do not tell.
    Unknown,
}

/// Fewest groups of trials by which a probability is found.
const GROUPS: usize = 256;
/// Odd trials by which a variance is half trusted.
const FEW_ODD: f64 = 20.0;
/// Most trials that a number of repeats is told up to.
const MOST_REPEATS: f64 = 1e9;

impl Runner {
    /// Runs trials of an experiment and gives what each told of a quantity; one trial where nothing is random.
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
    /// let [low, high] = [Coin(5.0), Coin(6.0)].map(|coin| runner.told(&coin, 0, 0..1000));
    /// assert_eq!(low[0], Some((6.0, 5.0)));
    /// // 4 and 6 against 5 and 7: three of four pairs are in order.
    /// assert_eq!(in_order(&low, &high).probability, 0.75);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn told<T: Trial + ?Sized>(
        &self,
        trial: &T,
        quantity: usize,
        numbers: Range<u64>,
    ) -> Vec<Told> {
        let count = numbers.end.saturating_sub(numbers.start);
        let count = if trial.is_random() {
            count
        } else {
            count.min(1)
        };
        let run = |record: &mut Record, place: u64| {
            let told = record.alone(&trial, numbers.start + place, |told| mean(told, quantity));
            told.ok().flatten()
        };
        self.install(|| {
            let places = (0..count as usize).into_par_iter();
            places
                .map_init(Record::default, |record, place| run(record, place as u64))
                .collect()
        })
    }
}

/// Mean estimate and mean truth of a quantity in a trial; `None` without observations.
fn mean(trial: &TrialObservations<'_>, quantity: usize) -> Told {
    let count = trial.of(quantity).count() as f64;
    let (mut estimate, mut truth) = (0.0, 0.0);
    for observation in trial.of(quantity) {
        estimate += observation.estimate / count;
        truth += observation.truth / count;
    }
    (count > 0.0 && estimate.is_finite() && truth.is_finite()).then_some((estimate, truth))
}

/// Probability that an estimate of experiment `low` is below an estimate of experiment `high`, over all pairs of
/// trials. The two experiments must have drawn different random numbers. Equal estimates count half, so that
/// indistinguishable experiments give one half. A failed trial counts as not in order.
///
/// This is Mann and Whitney's statistic with the variance of Sen (1960). Wilson's interval uses the number of
/// independent trials that would have the same variance.
pub fn in_order(low: &[Told], high: &[Told]) -> Order {
    order(&estimates(low), &estimates(high))
}

/// Probability that trials of two experiments both tell more than `limit`, such as a share of places classified right that
/// is more than half. A trial that failed does not.
pub fn both_above(one: &[Told], other: &[Told], limit: f64) -> Order {
    above(&estimates(one), &estimates(other), limit)
}

/// Number of trials of each experiment, the mean of which is in order with the probability `confidence`; with `limit`, those
/// whose means are both above it. A mean is that of the trials that succeed.
pub fn repeats(one: &[Told], other: &[Told], limit: Option<f64>, confidence: f64) -> Repeats {
    let (one, other) = (estimates(one), estimates(other));
    let told = |each: usize| {
        let (one, other) = (means(&one, each), means(&other, each));
        match limit {
            None => order(&one, &other),
            Some(limit) => above(&one, &other, limit),
        }
        .probability
    };
    if told(1) >= confidence {
        return Repeats::Found(1);
    }
    let most = one.len().min(other.len()) / GROUPS;
    // The first power of two that does, then the least number between.
    let mut enough = 2;
    while enough <= most && told(enough) < confidence {
        enough *= 2;
    }
    if enough <= most {
        let (mut few, mut enough) = (enough / 2, enough);
        while enough - few > 1 {
            let middle = few + (enough - few) / 2;
            if told(middle) >= confidence {
                enough = middle;
            } else {
                few = middle;
            }
        }
        return Repeats::Found(enough as u64);
    }
    beyond(&one, &other, limit, confidence, most)
}

/// Repeats that groups are too few for.
fn beyond(
    one: &[Option<f64>],
    other: &[Option<f64>],
    limit: Option<f64>,
    confidence: f64,
    most: usize,
) -> Repeats {
    let (Some(one), Some(other)) = (Moments::of(one), Moments::of(other)) else {
        return Repeats::Never;
    };
    // Separations in standard deviations of a single trial, each positive where means come out right.
    let separations = match limit {
        None => vec![(
            other.mean - one.mean,
            libm::hypot(one.std, other.std),
            libm::hypot(one.std_error(), other.std_error()),
        )],
        Some(limit) => [one, other]
            .map(|each| (each.mean - limit, each.std, each.std_error()))
            .to_vec(),
    };
    let tail = match limit {
        None => 1.0 - confidence,
        // Both must be right.
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

/// Moments of the trials that succeeded.
#[derive(Clone, Copy)]
struct Moments {
    mean: f64,
    std: f64,
    count: f64,
    success: f64,
}

impl Moments {
    fn of(told: &[Option<f64>]) -> Option<Self> {
        let values: Vec<f64> = told.iter().flatten().copied().collect();
        let count = values.len() as f64;
        let first = *values.first()?;
        let mean = values
            .iter()
            .map(|value| (value - first) / count)
            .sum::<f64>();
        let squares = values.iter().map(|value| {
            let deviation = value - first - mean;
            deviation * deviation / (count - 1.0).max(1.0)
        });
        let moments = Self {
            mean: first + mean,
            std: squares.sum::<f64>().sqrt(),
            count,
            success: count / told.len() as f64,
        };
        (moments.mean.is_finite() && moments.std.is_finite()).then_some(moments)
    }

    fn std_error(&self) -> f64 {
        self.std / self.count.sqrt()
    }
}

fn estimates(told: &[Told]) -> Vec<Option<f64>> {
    told.iter()
        .map(|told| told.map(|(estimate, _)| estimate))
        .collect()
}

/// Means of consecutive trials, so many each, of those that succeeded.
fn means(told: &[Option<f64>], each: usize) -> Vec<Option<f64>> {
    // One trial tells all where nothing is random.
    if each == 1 || told.len() == 1 {
        return told.to_vec();
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
    told.chunks_exact(each).map(mean).collect()
}

/// Numbers of the experiments' trials that succeeded, ascending.
fn sorted(told: &[Option<f64>]) -> Vec<f64> {
    let mut sorted: Vec<f64> = told.iter().flatten().copied().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
}

fn order(low: &[Option<f64>], high: &[Option<f64>]) -> Order {
    let (sorted_low, sorted_high) = (sorted(low), sorted(high));
    // Share of the others' trials that each is in order with.
    let half_and_above = |sorted: &[f64], value: f64| {
        let [below, up_to] = [
            sorted.partition_point(|other| *other < value),
            sorted.partition_point(|other| *other <= value),
        ];
        (0.5 * (below + up_to) as f64, sorted.len() as f64)
    };
    let of_low = low.iter().map(|told| {
        told.map_or(0.0, |value| {
            let (below, all) = half_and_above(&sorted_high, value);
            (all - below) / high.len() as f64
        })
    });
    let of_high = high.iter().map(|told| {
        told.map_or(0.0, |value| {
            half_and_above(&sorted_low, value).0 / low.len() as f64
        })
    });
    let all = || of_low.clone().chain(of_high.clone());
    let odd = all().filter(|share| *share < 1.0).count();
    let even = all().filter(|share| *share > 0.0).count();
    let (mean, of_low) = mean_and_variance(of_low);
    let (_, of_high) = mean_and_variance(of_high);
    interval(
        mean,
        of_low + of_high,
        odd.min(even),
        [low.len(), high.len()],
    )
}

fn above(one: &[Option<f64>], other: &[Option<f64>], limit: f64) -> Order {
    let is_above =
        |told: &Option<f64>| told.map_or(0.0, |value| f64::from(u8::from(value > limit)));
    let all = || one.iter().chain(other).map(is_above);
    let odd = all().filter(|share| *share < 1.0).count();
    let even = all().filter(|share| *share > 0.0).count();
    let (one_share, one_variance) = mean_and_variance(one.iter().map(is_above));
    let (other_share, other_variance) = mean_and_variance(other.iter().map(is_above));
    let variance =
        other_share * other_share * one_variance + one_share * one_share * other_variance;
    let counts = [one.len(), other.len()];
    interval(one_share * other_share, variance, odd.min(even), counts)
}

/// Mean of some numbers, and the variance of that mean; 0 of a single one, which is then exact.
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

/// A probability with its interval, from the variance with which it was found in so many trials of each experiment; `odd`
/// are the trials by which it is neither 0 nor 1.
fn interval(probability: f64, variance: f64, odd: usize, [one, other]: [usize; 2]) -> Order {
    if one == 0 || other == 0 || !probability.is_finite() {
        return Order {
            probability: 0.0,
            low: 0.0,
            high: 1.0,
        };
    }
    // Where nothing is random, nothing is uncertain.
    if one == 1 && other == 1 {
        return Order {
            probability,
            low: probability,
            high: probability,
        };
    }
    // Independent trials that would tell as much: no fewer than the random experiment of fewer trials has, and no more than
    // these where a few odd trials alone tell of the variance.
    let fewest = match (one, other) {
        (1, random) | (random, 1) => random,
        (one, other) => one.min(other),
    } as f64;
    let as_many = probability * (1.0 - probability) / variance;
    let trusted = odd as f64 / (odd as f64 + FEW_ODD);
    let more = if as_many.is_finite() {
        (as_many - fewest).max(0.0)
    } else {
        0.0
    };
    let as_many = fewest + trusted * more;
    let (low, high) = wilson(probability, as_many);
    Order {
        probability,
        low,
        high,
    }
}
