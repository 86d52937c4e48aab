//! Tasks: slices of blocks, and cells that end when a statistic is precise enough.

use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use palpate_sweep::{
    BLOCK, CellStatistics, Observation, Record, Stop, Sweep, SweepError, Taken, Task, Trial,
    Watched,
};

use crate::{normal, observation, runner};

/// Several quantities, varied truths, verdicts and failures; each trial takes a while.
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

/// Tasks with an experiment of one kind in all cells.
struct Tasks<F> {
    tasks: Vec<Task>,
    experiment: F,
    stop: Option<Stop>,
}

impl<T: Trial + Send, F: Fn() -> T + Sync> Sweep for Tasks<F> {
    type Trial = T;
    type Result = CellStatistics;
    type Error = Infallible;

    fn tasks(&self) -> u64 {
        self.tasks.len() as u64
    }

    fn task(&self, number: u64) -> Task {
        self.tasks[number as usize]
    }

    fn set_up(&self, _cell: usize) -> Result<T, Infallible> {
        Ok((self.experiment)())
    }

    fn stop(&self, _trial: &T) -> Option<Stop> {
        self.stop
    }

    fn finish(&self, _cell: usize, _trial: &T, statistics: CellStatistics) -> CellStatistics {
        statistics
    }
}

fn statistics(
    threads: usize,
    sweep: &impl Sweep<Result = CellStatistics, Error = Infallible>,
) -> Vec<CellStatistics> {
    let mut all = Vec::new();
    let never = AtomicBool::new(false);
    let mut take = |number, taken| {
        assert_eq!(number, all.len() as u64);
        if let Taken::Result(cell) = taken {
            all.push(cell);
        }
        ControlFlow::Continue(())
    };
    runner(threads)
        .stream(sweep, &never, &|_| (), &mut take)
        .unwrap();
    all
}

/// One task per cell, with these numbers of trials.
fn tasks(trials: &[u64]) -> Vec<Task> {
    let task = |(cell, &trials)| Task {
        cell,
        trials,
        may_stop: false,
    };
    trials.iter().enumerate().map(task).collect()
}

fn rich(wait_us: u64, places: u64, trials: u64) -> Tasks<impl Fn() -> Rich + Sync> {
    Tasks {
        tasks: tasks(&[trials, 3, trials / 2]),
        experiment: move || Rich {
            wait: Duration::from_micros(wait_us),
            places,
        },
        stop: None,
    }
}

#[test]
fn slices_of_blocks_leave_no_trace() {
    for places in [1, 9] {
        // Most blocks of quick trials are whole, those of slow ones are divided into slices of some 40 trials.
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

#[test]
fn one_trial_tells_all_where_nothing_is_random() {
    struct Still(AtomicU64);
    impl Trial for Still {
        fn quantities(&self) -> usize {
            1
        }
        fn run(&self, _trial: u64, record: &mut Record) -> Result<(), &'static str> {
            self.0.fetch_add(1, Ordering::Relaxed);
            record.observe(0, observation(3.0, 2.0, None));
            Ok(())
        }
        fn is_random(&self) -> bool {
            false
        }
    }
    for trials in [1, 5000, 1_000_000] {
        let sweep = Tasks {
            tasks: tasks(&[trials]),
            experiment: || Still(AtomicU64::new(0)),
            stop: None,
        };
        let cell = statistics(2, &sweep).remove(0);
        assert_eq!(cell.trials, 1);
        let summary = cell.quantities[0];
        assert_eq!((summary.observations, summary.bias), (1, Some(1.0)));
    }
}

/// Gaussian errors at several places, which are the same or differ.
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

/// Trials that a cell of these has until the rule ends it.
fn trials(statistic: Watched, places: u64, are_same: bool, scale: f64, min_trials: u64) -> u64 {
    let stop = Stop {
        quantity: 0,
        statistic,
        relative_standard_error: 0.01,
        min_trials,
    };
    let task = |cell| Task {
        cell,
        trials: 100_000,
        may_stop: true,
    };
    let sweep = Tasks {
        tasks: (0..3).map(task).collect(),
        experiment: move || Places {
            places,
            are_same,
            scale,
        },
        stop: Some(stop),
    };
    let all = statistics(2, &sweep);
    assert_eq!(format!("{:?}", all[0]), format!("{:?}", all[2]));
    all[0].trials
}

#[test]
fn a_cell_ends_when_its_statistic_is_known() {
    // Relative standard errors of N Gaussian errors: 1/√(2N) of their rms, √(π/2 − 1)/√N of their mean magnitude, and
    // 0.1/√N of a mean that is ten standard deviations from 0.
    for scale in [1.0, 1e-200, 1e200] {
        assert_eq!(trials(Watched::RmsError, 1, true, scale, 0), 8 * BLOCK);
        assert_eq!(trials(Watched::MeanAbsError, 1, true, scale, 0), 8 * BLOCK);
        assert_eq!(trials(Watched::Mean, 1, true, scale, 0), BLOCK);
    }
    assert_eq!(trials(Watched::Mean, 1, true, 1.0, 3000), 4 * BLOCK);
    assert_eq!(trials(Watched::RmsError, 1, true, 1.0, 1_000_000), 100_000);
}

/// Cells of [`Rich`], each of which ends by a rule.
fn ruled(
    cells: usize,
    wait_us: u64,
    places: u64,
    max: u64,
    error: f64,
) -> Tasks<impl Fn() -> Rich + Sync> {
    let task = |cell| Task {
        cell,
        trials: max,
        may_stop: true,
    };
    Tasks {
        tasks: (0..cells).map(task).collect(),
        experiment: move || Rich {
            wait: Duration::from_micros(wait_us),
            places,
        },
        stop: Some(Stop {
            quantity: 0,
            statistic: Watched::RmsError,
            relative_standard_error: error,
            min_trials: 0,
        }),
    }
}

#[test]
fn threads_that_share_a_cell_with_a_rule_leave_no_trace() {
    for (places, max, error) in [
        (1, 1_000_000, 0.02),
        (1, 1_000_000, 0.5),
        // More observations than are kept until the end of a block.
        (9, 1_000_000, 0.02),
        // No rule ends it, at the end of a block, within one and within the first.
        (1, 2048, 0.0),
        (1, 2500, 0.0),
        (1, 700, 0.0),
    ] {
        // The cells before the last are run by one thread each.
        let alone = statistics(1, &ruled(2, 0, places, max, error));
        assert_eq!(format!("{:?}", alone[0]), format!("{:?}", alone[1]));
        for (threads, wait_us) in [(1, 100), (2, 0), (3, 20), (3, 100)] {
            let shared = statistics(threads, &ruled(1, wait_us, places, max, error));
            assert_eq!(
                format!("{shared:?}"),
                format!("{:?}", &alone[..1]),
                "{places} places, {max} trials, {error}, {threads} threads, {wait_us} us"
            );
        }
    }
}

#[test]
fn threads_share_a_cell_with_a_rule() {
    // Sleeping trials, so that processors are no matter.
    struct Sleeps;
    impl Trial for Sleeps {
        fn quantities(&self) -> usize {
            1
        }
        fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
            std::thread::sleep(Duration::from_micros(300));
            record.observe(0, observation(normal(trial), 0.0, None));
            Ok(())
        }
    }
    let time = |threads| {
        let rich = ruled(1, 0, 1, 4096, 0.02);
        let sweep = Tasks {
            tasks: rich.tasks,
            experiment: || Sleeps,
            stop: rich.stop,
        };
        let start = Instant::now();
        assert_eq!(statistics(threads, &sweep)[0].trials, 2 * BLOCK);
        start.elapsed().as_secs_f64()
    };
    assert!(time(4) < 0.6 * time(1));
}

#[test]
fn a_cell_with_a_rule_in_which_nothing_is_random_has_one_trial() {
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
    let rich = ruled(2, 0, 1, u64::MAX, 0.01);
    let sweep = Tasks {
        tasks: rich.tasks,
        experiment: || Still,
        stop: rich.stop,
    };
    for threads in [1, 3] {
        let all = statistics(threads, &sweep);
        assert_eq!((all[0].trials, &all[0]), (1, &all[1]));
    }
}

#[test]
fn observations_of_one_trial_count_as_one_where_they_go_together() {
    assert_eq!(trials(Watched::RmsError, 16, true, 1.0, 0), 8 * BLOCK);
    // Independent ones tell more: 1/√(2 · 16 N).
    assert_eq!(trials(Watched::RmsError, 16, false, 1.0, 0), BLOCK);
}

#[test]
fn a_sweep_that_is_left_off_has_given_the_first_results() {
    let mut taken = 0;
    let take = &mut |_: u64, _: Taken<CellStatistics>| {
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
    let take = &mut |_: u64, _: Taken<CellStatistics>| {
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
    statistics(
        3,
        &Tasks {
            tasks: tasks(&[1_000_000; 200]),
            experiment: || Panics,
            stop: None,
        },
    );
}
