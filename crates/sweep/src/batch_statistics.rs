//! Statistics of a cell's trials, collected in batches. The grouped jackknife estimates the standard error of each
//! statistic: it leaves out one batch after another, computes the statistic from the remaining batches, and derives the
//! standard error from the scatter of these results.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use rayon::prelude::*;

use crate::cell::{BLOCK, Trial};
use crate::certainty::student;
use crate::partial_statistics::{Accumulator, Partial};
use crate::runner::Runner;
use crate::summary::CellStatistics;
use crate::trial_record::Record;

/// Number of batches into which the trials of a cell are divided. With 32 batches, the standard error has 31 degrees of
/// freedom, so Student's t distribution is nearly normal. With more batches, a batch of a cell with only 100 trials
/// would contain too few trials.
const BATCHES: u64 = 32;

/// Statistics of the trials of one cell, in 32 batches of equal size.
///
/// ```
/// use palpate_sweep::{Batches, Growth, Observation, Record, RunOptions, Runner, Trial};
///
/// /// Errors of ±0.5 and ±1.5, all equally often.
/// struct Dice;
/// impl Trial for Dice {
///     fn quantities(&self) -> usize { 1 }
///     fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
///         let estimate = 10.0 + [0.5, -1.5, 1.5, -0.5][trial as usize % 4];
///         record.observe(0, Observation { estimate, truth: 10.0, std: None, interval_holds: None });
///         Ok(())
///     }
/// }
/// let runner = Runner::new(&RunOptions::default())?;
/// let mut batches = Batches::from_trial(0, None);
/// runner.grow(vec![Growth { trial: &Dice, batches: &mut batches, trials: 1000 }]);
/// let rms = batches.estimate(|all| all.quantities[0].rms_error).ok_or("all trials succeed")?;
/// assert!((rms.value - 1.25_f64.sqrt()).abs() < 1e-12);
/// // All batches have the same errors, so the standard error is 0.
/// assert!(rms.std_error() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Batches {
    batches: Vec<Partial>,
    first: u64,
    next: u64,
    /// The quantities whose statistics are stored; all others are dropped to save memory. `None` if the statistics and
    /// histograms of all quantities are stored.
    stored: Option<Stored>,
}

/// The quantities of a cell whose statistics are stored, and whether the histograms of these quantities are stored too.
#[derive(Clone, Debug)]
struct Stored {
    quantities: Vec<usize>,
    histograms: bool,
}

/// A request to run more trials of a cell.
pub struct Growth<'a, T: ?Sized> {
    /// The experiment of the cell, which runs the trials.
    pub trial: &'a T,
    /// Batches to which the statistics of the new trials are added.
    pub batches: &'a mut Batches,
    /// Smallest number of trials that the batches must contain after the new trials were added. An experiment that is
    /// not random has only one trial in any case.
    pub trials: u64,
}

/// Estimated value of a statistic, computed from all trials of a cell. For each batch of trials, this struct also
/// contains the value that results if the batch is left out. The scatter of these values gives the standard error.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Value over all trials.
    pub value: f64,
    /// For each batch, the value of the statistic over all trials outside of this batch; empty if the experiment is not
    /// random.
    without: Vec<f64>,
    /// Standard deviation of an additional error of the statistic, such as the resolution of a histogram; 0 if there is
    /// none. The jackknife cannot estimate this error, because it has the same value in all batches.
    pub resolution: f64,
}

impl Batches {
    /// Batches without trials. The first trial that is run for them has the number `first`. To save memory, `stored` may
    /// restrict the stored statistics: to some quantities, and without their quantiles if its second value is false.
    pub fn from_trial(first: u64, stored: Option<(Vec<usize>, bool)>) -> Self {
        let stored = stored.map(|(quantities, histograms)| Stored {
            quantities,
            histograms,
        });
        Self {
            batches: vec![Partial::default(); BATCHES as usize],
            first,
            next: first,
            stored,
        }
    }

    /// Statistics of all trials. Statistics that are not stored are `None`.
    pub fn statistics(&self) -> CellStatistics {
        self.merged().statistics()
    }

    fn merged(&self) -> Partial {
        let mut all = Partial::default();
        for batch in self.batches.iter().filter(|batch| batch.trials > 0) {
            all.merge(batch.clone());
        }
        all
    }

    /// Estimates a statistic, and its standard error by the grouped jackknife. Returns `None` if the statistic is
    /// undefined for all trials together, or for the trials that remain when one of the batches is left out.
    pub fn estimate(&self, statistic: impl Fn(&CellStatistics) -> Option<f64>) -> Option<Estimate> {
        let value = statistic(&self.statistics())?;
        let run: Vec<&Partial> = self.batches.iter().filter(|one| one.trials > 0).collect();
        let mut without = Vec::new();
        if run.len() > 1 {
            // `behind[i]` contains the sums over all batches after batch i.
            let mut behind = vec![Partial::default(); run.len()];
            for place in (1..run.len()).rev() {
                let mut sum = run[place].clone();
                sum.merge(behind[place].clone());
                behind[place - 1] = sum;
            }
            let mut before = Partial::default();
            for (batch, behind) in run.into_iter().zip(behind) {
                let mut rest = before.clone();
                if behind.trials > 0 {
                    rest.merge(behind);
                }
                without.push(statistic(&rest.statistics())?);
                before.merge(batch.clone());
            }
        }
        Some(Estimate {
            value,
            without,
            resolution: 0.0,
        })
    }
}

impl Estimate {
    /// Applies `function`, for example the logarithm, to this statistic. Returns the estimate of the result, with its
    /// own standard error. `None` if one of the function's values is not finite.
    pub fn map(&self, function: impl Fn(f64) -> f64) -> Option<Self> {
        let finite = |value: f64| Some(function(value)).filter(|value| value.is_finite());
        let without: Option<Vec<f64>> = self.without.iter().map(|one| finite(*one)).collect();
        Some(Self {
            value: finite(self.value)?,
            without: without?,
            resolution: 0.0,
        })
    }

    /// Standard error of the estimated statistic; 0 if the experiment is not random and there is no additional error.
    pub fn std_error(&self) -> f64 {
        let count = self.without.len() as f64;
        if count < 2.0 {
            return self.resolution;
        }
        // Subtract the first value from all values. Otherwise a scatter that is small compared with the values would be
        // lost by rounding.
        let origin = self.without[0];
        let deviations = self.without.iter().map(|one| one - origin);
        let scale = deviations.clone().map(f64::abs).fold(0.0, f64::max);
        if !(scale > 0.0 && scale.is_finite()) {
            return self.resolution;
        }
        let scaled = deviations.map(|deviation| deviation / scale);
        let mean = scaled.clone().sum::<f64>() / count;
        let squares: f64 = scaled.map(|one| (one - mean).powi(2)).sum();
        let of_batches = scale * ((count - 1.0) / count * squares).sqrt();
        libm::hypot(of_batches, self.resolution)
    }

    /// Score of the statement that the true value is at most `limit` (if `sign` is 1) or at least `limit` (if `sign` is
    /// −1): the number of standard errors by which the estimated value is on the stated side of `limit`, see
    /// [`normal_tail`](palpate_statistics::normal_tail). An exact value that equals `limit` fulfils both statements.
    pub fn score(&self, limit: f64, sign: f64) -> f64 {
        let degrees = (self.without.len() as f64 - 1.0).max(1.0);
        student(sign * (limit - self.value), self.std_error(), degrees)
    }
}

struct Job<'a, T: ?Sized> {
    trial: &'a T,
    trials: Range<u64>,
    stored: Option<&'a Stored>,
    batch: &'a mut Partial,
}

impl<T: Trial + ?Sized> Job<'_, T> {
    fn run(self, record: &mut Record) {
        let mut ran = Partial::new(self.trial.quantities());
        let mut start = self.trials.start;
        while start < self.trials.end {
            let end = self.trials.end.min(start.saturating_add(BLOCK));
            let never = AtomicBool::new(false);
            ran.run_block(&self.trial, start..end, record, &never, None);
            start = end;
        }
        if let Some(stored) = self.stored {
            stored.drop_others(&mut ran);
        }
        self.batch.merge(ran);
    }
}

impl Stored {
    fn drop_others(&self, partial: &mut Partial) {
        for (place, accumulator) in partial.quantities.iter_mut().enumerate() {
            if !self.quantities.contains(&place) {
                *accumulator = Accumulator::default();
            } else if !self.histograms {
                accumulator.drop_histogram();
            }
        }
    }
}

impl Runner {
    /// Runs more trials of some cells. The numbers of the new trials continue from the last trial in the batches.
    pub fn grow<T: Trial + ?Sized>(&self, cells: Vec<Growth<'_, T>>) {
        let mut jobs: Vec<Job<'_, T>> = Vec::new();
        for growth in cells {
            let (trial, grown) = (growth.trial, growth.batches);
            let stored = grown.stored.as_ref();
            let done = grown.next - grown.first;
            // All trials of an experiment that is not random would be equal. So it has only one trial, which is in the
            // first batch.
            let (count, each) = match trial.is_random() {
                true => (
                    grown.batches.len(),
                    growth.trials.saturating_sub(done).div_ceil(BATCHES),
                ),
                false => (1, u64::from(done == 0 && growth.trials > 0)),
            };
            for batch in grown.batches.iter_mut().take(count) {
                let trials = grown.next..grown.next.saturating_add(each);
                grown.next = trials.end;
                if !trials.is_empty() {
                    jobs.push(Job {
                        trial,
                        trials,
                        stored,
                        batch,
                    });
                }
            }
        }
        self.install(|| {
            let jobs = jobs.into_par_iter().with_max_len(1);
            jobs.for_each_init(Record::default, |record, job| job.run(record));
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exact_value_at_the_limit_fulfils_both_statements() {
        let exact = Estimate {
            value: 77.0,
            without: vec![77.0; 32],
            resolution: 0.0,
        };
        let meets = |limit| [1.0, -1.0].map(|sign| exact.score(limit, sign) > 0.0);
        assert_eq!(
            [76.0, 77.0, 78.0].map(meets),
            [[false, true], [true; 2], [true, false]]
        );
    }
}
