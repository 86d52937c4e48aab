//! Tests the tasks of the runner: blocks that several threads share, and cells that a stopping rule ends.

use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use palpate_sweep::{
    CellStatistics, Observation, Record, StoppingRule, StoppingStatistic, Sweep, SweepError,
    SweepOutput, Trial,
};

use crate::{BLOCK, Tasks, normal, observation, runner, streamed};

/// An experiment with several quantities, varying true values, reported coverage and failures. Each trial takes at
/// least the time `wait`.
struct Rich {
    wait: Duration,
    places: u64,
}

impl Trial for Rich {
    fn quantities(&self) -> usize {
        3
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        let start = Instant::now();
        while start.elapsed() < self.wait {}
        for place in 0..self.places {
            let estimate = 2.0 + normal(31 * trial + place);
            let truth = if trial % 700 < 300 { 2.0 } else { place as f64 };
            let interval_holds = (trial % 6 == 2).then_some([
                place.is_multiple_of(3),
                place.is_multiple_of(2),
                true,
            ]);
            record.observe(
                0,
                Observation {
                    interval_holds,
                    ..observation(estimate, truth, Some(0.7))
                },
            );
        }
        record.observe(1, observation(normal(trial), 0.0, None));
        let interval_holds =
            (trial % 5 == 1).then_some([trial.is_multiple_of(7), trial.is_multiple_of(3), true]);
        let std = (trial % 4 < 2).then_some(0.5);
        record.observe(
            2,
            Observation {
                interval_holds,
                ..observation(normal(7 * trial), 1.0, std)
            },
        );
        if trial % 11 == 4 { Err("rank") } else { Ok(()) }
    }
}

fn statistics(
    threads: usize,
    sweep: &impl Sweep<Result = CellStatistics, Error = Infallible>,
) -> Vec<CellStatistics> {
    streamed(threads, sweep, &AtomicBool::new(false)).unwrap()
}

type Infallibly<T> = Result<T, Infallible>;

fn rich(
    wait_us: u64,
    places: u64,
    trials: u64,
) -> Tasks<impl Fn(usize) -> Infallibly<Rich> + Sync> {
    let wait = Duration::from_micros(wait_us);
    Tasks::new(&[trials, 3, trials / 2], move |_| Ok(Rich { wait, places }))
}

#[test]
fn slices_of_blocks_do_not_change_results() {
    for places in [1, 9] {
        // Fast trials mostly run in whole blocks. Slow trials run in parts of a block (slices) with about 40 trials
        // each. Both must give the same results.
        let whole = statistics(1, &rich(0, places, 2500));
        for threads in [1, 3] {
            let sliced = statistics(threads, &rich(100, places, 2500));
            assert_eq!(
                format!("{sliced:?}"),
                format!("{whole:?}"),
                "{places} places"
            );
        }
    }
}

struct Still;

impl Trial for Still {
    fn quantities(&self) -> usize {
        1
    }

    fn run(&self, _trial: u64, record: &mut Record) -> Result<(), &'static str> {
        record.observe(0, observation(3.0, 2.0, None));
        Ok(())
    }

    fn is_random(&self) -> bool {
        false
    }
}

#[test]
fn an_experiment_that_is_not_random_has_one_trial() {
    for trials in [1, 5000, 1_000_000] {
        let sweep = Tasks::new(&[trials], |_| Ok(Still));
        let cell = statistics(2, &sweep).remove(0);
        assert_eq!(cell.trials, 1);
        let summary = cell.quantities[0];
        assert_eq!((summary.observations, summary.bias), (1, Some(1.0)));
    }
}

/// An experiment that observes a quantity at several places, with Gaussian errors. In each trial, the errors at all
/// places are either equal or independent of each other.
struct Places {
    places: u64,
    are_same: bool,
    scale: f64,
}

impl Trial for Places {
    fn quantities(&self) -> usize {
        1
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        for place in 0..self.places {
            let number = if self.are_same {
                trial
            } else {
                self.places * trial + place
            };
            let estimate = self.scale * (10.0 + normal(number));
            record.observe(0, observation(estimate, self.scale * 10.0, None));
        }
        Ok(())
    }
}

fn trials(
    statistic: StoppingStatistic,
    places: u64,
    are_same: bool,
    scale: f64,
    min_trials: u64,
) -> u64 {
    let rule = StoppingRule {
        quantity: 0,
        statistic,
        relative_standard_error: 0.01,
        min_trials,
    };
    let set_up = move |_| {
        Ok(Places {
            places,
            are_same,
            scale,
        })
    };
    let sweep = ruled_by(rule, 3, 100_000, set_up);
    let all = statistics(2, &sweep);
    assert_eq!(format!("{:?}", all[0]), format!("{:?}", all[2]));
    all[0].trials
}

#[test]
fn a_cell_ends_when_its_statistic_is_accurate() {
    // Relative standard errors of three statistics of N Gaussian errors: 1/√(2N) for the rms error, √(π/2 − 1)/√N for
    // the mean absolute error, and 0.1/√N for a mean that is ten standard deviations from 0.
    for scale in [1.0, 1e-200, 1e200] {
        assert_eq!(
            trials(StoppingStatistic::RmsError, 1, true, scale, 0),
            8 * BLOCK
        );
        assert_eq!(
            trials(StoppingStatistic::MeanAbsError, 1, true, scale, 0),
            8 * BLOCK
        );
        assert_eq!(trials(StoppingStatistic::Mean, 1, true, scale, 0), BLOCK);
    }
    assert_eq!(
        trials(StoppingStatistic::Mean, 1, true, 1.0, 3000),
        4 * BLOCK
    );
    assert_eq!(
        trials(StoppingStatistic::RmsError, 1, true, 1.0, 1_000_000),
        100_000
    );
}

fn ruled_by<F>(rule: StoppingRule, cells: usize, trials: u64, set_up: F) -> Tasks<F> {
    let mut sweep = Tasks::new(&vec![trials; cells], set_up);
    sweep.tasks.iter_mut().for_each(|task| task.may_stop = true);
    sweep.rule = Some(rule);
    sweep
}

/// Tasks whose cells end when the relative standard error of their rms error is at most `error`.
fn ruled<F>(cells: usize, trials: u64, error: f64, set_up: F) -> Tasks<F> {
    let rule = StoppingRule {
        quantity: 0,
        statistic: StoppingStatistic::RmsError,
        relative_standard_error: error,
        min_trials: 0,
    };
    ruled_by(rule, cells, trials, set_up)
}

#[test]
fn threads_that_share_a_cell_do_not_change_results() {
    for (places, max, error) in [
        (1, 1_000_000, 0.02),
        (1, 1_000_000, 0.5),
        // Each trial has nine observations. The observations of a trial are added to the sums after this trial, not at
        // the end of a block.
        (9, 1_000_000, 0.02),
        // The required standard error of the stopping rule is 0, so the rule never ends a cell. In these three cases,
        // the last trial of the cell is at the end of a block, within a later block, and within the first block.
        (1, 2048, 0.0),
        (1, 2500, 0.0),
        (1, 700, 0.0),
    ] {
        // The runner shares only the last cell between several threads. Every other cell is run by one thread.
        let rich = |wait_us| {
            let wait = Duration::from_micros(wait_us);
            move |_| Ok(Rich { wait, places })
        };
        let alone = statistics(1, &ruled(2, max, error, rich(0)));
        assert_eq!(format!("{:?}", alone[0]), format!("{:?}", alone[1]));
        for (threads, wait_us) in [(1, 100), (2, 0), (3, 20), (3, 100)] {
            let shared = statistics(threads, &ruled(1, max, error, rich(wait_us)));
            assert_eq!(
                format!("{shared:?}"),
                format!("{:?}", &alone[..1]),
                "{places} places, {max} trials, {error}, {threads} threads, {wait_us} us"
            );
        }
    }
}

#[test]
fn equal_observations_of_a_trial_count_as_one() {
    assert_eq!(
        trials(StoppingStatistic::RmsError, 16, true, 1.0, 0),
        8 * BLOCK
    );
    // If the errors of a trial are independent, fewer trials are needed than if they are equal: with 16 observations in
    // each of N trials, the relative standard error of the rms error is 1/√(2 · 16 N) instead of 1/√(2 N).
    assert_eq!(
        trials(StoppingStatistic::RmsError, 16, false, 1.0, 0),
        BLOCK
    );
}

#[test]
fn a_cancelled_sweep_has_returned_the_first_results() {
    let mut taken = 0;
    let take = &mut |_: u64, _: SweepOutput<CellStatistics>| {
        taken += 1;
        match taken {
            2 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    };
    let error = runner(2).stream(&rich(10, 1, 5000), &AtomicBool::new(false), &|_| (), take);
    assert!(matches!(error, Err(SweepError::Cancelled)));
    assert_eq!(taken, 2);

    let cancelled = AtomicBool::new(false);
    let mut taken = 0;
    let take = &mut |_: u64, _: SweepOutput<CellStatistics>| {
        taken += 1;
        cancelled.store(true, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    let error = runner(2).stream(&rich(10, 1, 5000), &cancelled, &|_| (), take);
    assert!(matches!(error, Err(SweepError::Cancelled)));
    assert!((1..3).contains(&taken), "{taken}");
}

#[test]
#[should_panic(expected = "a trial went wrong")]
fn a_panic_of_one_thread_ends_them_all() {
    struct Panics;
    impl Trial for Panics {
        fn quantities(&self) -> usize {
            0
        }
        fn run(&self, trial: u64, _record: &mut Record) -> Result<(), &'static str> {
            assert!(trial != 30_000, "a trial went wrong");
            Ok(())
        }
    }
    statistics(3, &Tasks::new(&[1_000_000; 200], |_| Ok(Panics)));
}
