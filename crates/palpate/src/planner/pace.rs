//! Measures the time per trial and predicts the time of a run.

use std::num::{NonZeroU64, NonZeroUsize};
use std::time::Duration;

use palpate_sweep::{Cell, Clock, JOB, Runner, Trial};

/// Upper limit for the shortest accepted duration of a measurement (`long_enough` in [`seconds_per_trial`]).
const LONGEST: Duration = Duration::from_millis(10);
/// Lower limit for the shortest accepted duration of a measurement (`long_enough` in [`seconds_per_trial`]).
const SHORTEST: Duration = Duration::from_millis(1);
/// A measurement of trials that takes longer than this time is not repeated: the delay of waking the threads is then
/// negligible.
const SLOW: Duration = Duration::from_millis(100);
const REPEATS: usize = 3;
const MAX_TIMED: u64 = 1 << 20;

/// Time per trial of each cell, s: the time that one thread needs for a trial while all threads run trials.
#[derive(Clone, Debug)]
pub(crate) struct Pace {
    seconds: Vec<f64>,
}

impl Pace {
    /// Measures the time per trial of several cells; all measurements together take about `limit`. The measured cells
    /// are spread evenly over all cells. The largest measured time is assumed for the cells that are not measured.
    pub(crate) fn of<T: Trial>(
        runner: &Runner,
        cells: &[T],
        limit: Duration,
        clock: &Clock<'_>,
    ) -> Self {
        let each = (limit / cells.len().max(1) as u32).clamp(SHORTEST, LONGEST);
        let start = clock();
        let mut seconds = vec![None; cells.len()];
        for cell in spread(cells.len()) {
            if clock().saturating_sub(start) >= limit && seconds.iter().any(Option::is_some) {
                break;
            }
            seconds[cell] = Some(seconds_per_trial(runner, &cells[cell], each, clock));
        }
        let dearest = seconds.iter().flatten().copied().fold(0.0, f64::max);
        let seconds = seconds.into_iter();
        Self {
            seconds: seconds.map(|one| one.unwrap_or(dearest)).collect(),
        }
    }

    pub(crate) fn seconds_per_trial(&self, cell: usize) -> f64 {
        self.seconds[cell]
    }

    /// Upper bound on the time of a run, s. `trials` contains the number of trials of each cell. The bound is Graham's
    /// bound (1966) for jobs that are started one after another as soon as a thread is idle.
    pub(crate) fn run_seconds(&self, trials: &[u64], threads: NonZeroUsize) -> f64 {
        let (mut sum, mut longest) = (0.0, 0.0_f64);
        for (&trials, &seconds) in trials.iter().zip(&self.seconds) {
            sum += trials as f64 * seconds;
            longest = longest.max(seconds.max(JOB.as_secs_f64()).min(trials as f64 * seconds));
        }
        let threads = threads.get() as f64;
        sum / threads + longest * (1.0 - 1.0 / threads)
    }

    /// Largest number of trials, up to `most`, for which a run takes at most `seconds`. Each cell with random numbers
    /// runs this number of trials; each other cell runs one trial. `None` if even a run with one trial per cell takes
    /// longer.
    pub(super) fn most_trials(
        &self,
        is_random: &[bool],
        threads: NonZeroUsize,
        seconds: f64,
        most: NonZeroU64,
    ) -> Option<NonZeroU64> {
        let fits = |trials: u64| {
            let trials: Vec<u64> = is_random
                .iter()
                .map(|&is_random| if is_random { trials } else { 1 })
                .collect();
            self.run_seconds(&trials, threads) <= seconds
        };
        if !fits(1) {
            return None;
        }
        if fits(most.get()) {
            return Some(most);
        }
        let (mut fit, mut unfit) = (1, most.get());
        while unfit - fit > 1 {
            let middle = fit + (unfit - fit) / 2;
            if fits(middle) {
                fit = middle;
            } else {
                unfit = middle;
            }
        }
        NonZeroU64::new(fit)
    }
}

/// The whole numbers below `count`, in the order of their reversed bits. The first few numbers of this order are
/// spread over the whole range.
pub(crate) fn spread(count: usize) -> impl Iterator<Item = usize> {
    let bits = count.next_power_of_two().trailing_zeros();
    (0..count.next_power_of_two())
        .map(move |number| match bits {
            0 => number,
            bits => number.reverse_bits() >> (usize::BITS - bits),
        })
        .filter(move |&number| number < count)
}

/// Seconds per trial of a cell, measured while all threads run trials of this cell.
///
/// The number of trials is doubled until they take at least `long_enough` together, because waking the threads takes
/// longer than a few short trials. The last measurement is repeated and the shortest time is used, because other
/// programs may have disturbed it. A measurement longer than [`SLOW`] is not repeated.
fn seconds_per_trial(
    runner: &Runner,
    trial: &dyn Trial,
    long_enough: Duration,
    clock: &Clock<'_>,
) -> f64 {
    let time = |trials: u64| {
        let start = clock();
        let timed = vec![Cell { trials, trial }; runner.threads().get()];
        std::hint::black_box(runner.run(&timed, &|_| ()));
        clock().saturating_sub(start)
    };
    let mut trials = 1;
    loop {
        let mut elapsed = time(trials);
        for _ in 0..REPEATS {
            if (long_enough..SLOW).contains(&elapsed) {
                elapsed = elapsed.min(time(trials));
            }
        }
        if elapsed >= long_enough || trials >= MAX_TIMED {
            return elapsed.as_secs_f64() / trials as f64;
        }
        trials *= 2;
    }
}
