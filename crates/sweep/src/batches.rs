//! Trials of a cell in batches, from which the standard error of any of its statistics follows.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use rayon::prelude::*;

use crate::certainty::student;
use crate::partial::{Accumulator, Partial};
use crate::record::Record;
use crate::runner::Runner;
use crate::summary::CellStatistics;
use crate::trial::{BLOCK, Trial};

/// Number of batches: enough for Student's t to be nearly normal, few enough for each to have several of few trials.
const BATCHES: u64 = 32;

/// Trials of one cell in 32 batches of as many trials each.
///
/// ```
/// use palpate_sweep::{Batches, Growth, Observation, Record, RunOptions, Runner, Trial};
///
/// /// Errs by ±0.5 or ±1.5, each as often.
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
/// let mut batches = Batches::from_trial(0);
/// runner.grow(vec![Growth { trial: &Dice, batches: &mut batches, trials: 1000 }]);
/// assert_eq!(batches.trials(), 1024);
/// let rms = batches.estimate(|all| all.quantities[0].rms_error).ok_or("all trials succeed")?;
/// assert!((rms.value - 1.25_f64.sqrt()).abs() < 1e-12);
/// // Every batch has the same eight rounds: there is no spread.
/// assert!(rms.std_error() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Batches {
    batches: Vec<Partial>,
    first: u64,
    next: u64,
    kept: Option<Kept>,
}

/// Choice of what is kept of the quantities of a cell.
#[derive(Clone, Debug)]
struct Kept {
    quantities: Vec<usize>,
    histograms: bool,
}

/// More trials of a cell.
pub struct Growth<'a, T: ?Sized> {
    /// Experiment of the cell.
    pub trial: &'a T,
    /// Trials of it so far.
    pub batches: &'a mut Batches,
    /// Number of trials that it is to have at least; one is enough where nothing is random.
    pub trials: u64,
}

/// Statistic of all trials, beside its values without each of the batches.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Value of all trials.
    pub value: f64,
    /// Values without each batch; none where nothing is random.
    without: Vec<f64>,
    /// Standard deviation of what else the value may be off.
    resolution: f64,
}

impl Batches {
    /// No trials yet; the first is to have this number.
    pub fn from_trial(first: u64) -> Self {
        Self {
            batches: vec![Partial::default(); BATCHES as usize],
            first,
            next: first,
            kept: None,
        }
    }

    /// Batches of these quantities alone, without their quantiles unless `histograms` are kept: less memory.
    #[must_use]
    pub fn keeping(self, quantities: Vec<usize>, histograms: bool) -> Self {
        Self {
            kept: Some(Kept {
                quantities,
                histograms,
            }),
            ..self
        }
    }

    /// Number of trials so far.
    pub fn trials(&self) -> u64 {
        self.next - self.first
    }

    /// Statistics of all trials. Of what is not kept there are none.
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

    /// A statistic of all trials with its standard error by the grouped jackknife; `None` where it is undefined, also
    /// without any one of the batches.
    pub fn estimate(&self, statistic: impl Fn(&CellStatistics) -> Option<f64>) -> Option<Estimate> {
        let value = statistic(&self.statistics())?;
        let run: Vec<&Partial> = self.batches.iter().filter(|one| one.trials > 0).collect();
        let mut without = Vec::new();
        if run.len() > 1 {
            // Sums of the batches behind each.
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
    /// The estimate of a function of the statistic; `None` where that is not finite.
    pub fn map(&self, function: impl Fn(f64) -> f64) -> Option<Self> {
        let finite = |value: f64| Some(function(value)).filter(|value| value.is_finite());
        let without: Option<Vec<f64>> = self.without.iter().map(|one| finite(*one)).collect();
        Some(Self {
            value: finite(self.value)?,
            without: without?,
            resolution: 0.0,
        })
    }

    /// The estimate with an error of this standard deviation that no batch shows, as that of a quantile of a histogram.
    #[must_use]
    pub fn with_resolution(self, resolution: f64) -> Self {
        Self { resolution, ..self }
    }

    /// Standard error of the value; 0 where nothing is random.
    pub fn std_error(&self) -> f64 {
        let count = self.without.len() as f64;
        if count < 2.0 {
            return self.resolution;
        }
        // About the first, so that a small spread about a large value is not lost.
        let origin = self.without[0];
        let scale = self
            .without
            .iter()
            .map(|one| (one - origin).abs())
            .fold(0.0, f64::max);
        if !(scale > 0.0 && scale.is_finite()) {
            return self.resolution;
        }
        let mean = self
            .without
            .iter()
            .map(|one| (one - origin) / scale)
            .sum::<f64>()
            / count;
        let squares: f64 = self
            .without
            .iter()
            .map(|one| ((one - origin) / scale - mean).powi(2))
            .sum();
        libm::hypot(
            scale * ((count - 1.0) / count * squares).sqrt(),
            self.resolution,
        )
    }

    /// Score by which the true value is at most `limit`; see [`normal_tail`](palpate_statistics::normal_tail).
    pub fn at_most(&self, limit: f64) -> f64 {
        self.score(limit - self.value)
    }

    /// Score by which the true value is at least `limit`; see [`normal_tail`](palpate_statistics::normal_tail).
    pub fn at_least(&self, limit: f64) -> f64 {
        self.score(self.value - limit)
    }

    fn score(&self, margin: f64) -> f64 {
        let degrees = (self.without.len() as f64 - 1.0).max(1.0);
        student(margin, self.std_error(), degrees)
    }
}

/// Trials of one batch that are to be run.
struct Job<'a, T: ?Sized> {
    trial: &'a T,
    trials: Range<u64>,
    kept: Option<&'a Kept>,
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
        if let Some(kept) = self.kept {
            kept.thin(&mut ran);
        }
        self.batch.merge(ran);
    }
}

impl Kept {
    fn thin(&self, partial: &mut Partial) {
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
    /// Runs more trials of some cells, each in batches: those that follow the trials that have been run.
    pub fn grow<T: Trial + ?Sized>(&self, cells: Vec<Growth<'_, T>>) {
        let mut jobs: Vec<Job<'_, T>> = Vec::new();
        for Growth {
            trial,
            batches,
            trials,
        } in cells
        {
            let Batches {
                batches,
                first,
                next,
                kept,
            } = batches;
            let kept = kept.as_ref();
            let done = *next - *first;
            if !trial.is_random() {
                if let (0, Some(batch), true) = (done, batches.first_mut(), trials > 0) {
                    let trials = *next..*next + 1;
                    *next += 1;
                    jobs.push(Job {
                        trial,
                        trials,
                        kept,
                        batch,
                    });
                }
                continue;
            }
            let each = trials.saturating_sub(done).div_ceil(BATCHES);
            for batch in batches {
                let trials = *next..next.saturating_add(each);
                *next = trials.end;
                if !trials.is_empty() {
                    jobs.push(Job {
                        trial,
                        trials,
                        kept,
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
