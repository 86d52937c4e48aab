//! Tests that results depend neither on the number of threads nor on the division of the trials into blocks and jobs.

use std::convert::Infallible;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use palpate_sweep::{Cell, Observations, Record, SweepError, Trial};

use crate::{
    BLOCK, Function, Tasks, normal, observation, observing, run_cell, run_with, runner, streamed,
};

fn digits(cells: &[palpate_sweep::CellStatistics]) -> String {
    format!("{cells:?}")
}

#[test]
fn one_two_and_seven_threads_return_the_same_bits() {
    let constant = observing(|trial| observation(3.0 + 0.1 * normal(trial), 3.0, Some(0.1)));
    let moving = observing(|trial| observation(normal(trial), (trial / 3000) as f64, None));
    let failing = Function {
        quantities: 3,
        function: |trial: u64, record: &mut Record| {
            for quantity in 0..3 {
                let estimate = 1e9 + normal(3 * trial + quantity);
                let std = trial.is_multiple_of(2).then_some(1.0);
                record.observe(quantity as usize, observation(estimate, 1e9, std));
            }
            if trial % 7 == 3 { Err("rank") } else { Ok(()) }
        },
    };
    let mut cells = Vec::new();
    for trials in [0, 1, 5000, 40 * BLOCK + 7, 1023, 1024, 1025] {
        let experiments: [&dyn Trial; 3] = [&constant, &moving, &failing];
        cells.extend(experiments.map(|trial| Cell { trials, trial }));
    }
    let one = run_with(1, &cells);
    assert_eq!(one.len(), cells.len());
    assert_eq!(digits(&run_with(2, &cells)), digits(&one));
    assert_eq!(digits(&run_with(7, &cells)), digits(&one));
}

/// An experiment in which every seventh trial fails. Up to five trials between two failures are run together.
struct Together;

impl Trial for Together {
    fn quantities(&self) -> usize {
        1
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        record.observe(0, observation(normal(trial), 0.0, None));
        if trial % 7 == 3 { Err("rank") } else { Ok(()) }
    }

    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        let fit = |&trial: &u64| trial < trials.end && trial % 7 != 3;
        let together = (trials.start..trials.start + 5).take_while(fit);
        let estimates: Vec<f64> = together.map(normal).collect();
        record.observe_together(&[Observations {
            estimates: &estimates,
            truth: 0.0,
            stds: None,
        }]) as u64
    }
}

#[test]
fn trials_that_run_together_are_those_that_run_one_by_one() {
    let apart = Function {
        quantities: 1,
        function: |trial: u64, record: &mut Record| Together.run(trial, record),
    };
    for trials in [0, 1, 6, BLOCK - 1, 5 * BLOCK + 3] {
        let together = run_cell(trials, &Together);
        assert_eq!(together.trials, trials);
        assert_eq!(digits(&[together]), digits(&[run_cell(trials, &apart)]));
    }
}

#[test]
fn progress_adds_up_to_all_trials() {
    let trial = observing(|_| observation(0.0, 0.0, None));
    let cells = [0, 1, 1025, 10_000].map(|trials| Cell {
        trials,
        trial: &trial,
    });
    let finished = AtomicU64::new(0);
    let progress = |trials| {
        finished.fetch_add(trials, Ordering::Relaxed);
    };
    runner(2).run(&cells, &progress);
    assert_eq!(finished.into_inner(), 11_026);
}

#[test]
fn a_cancelled_run_starts_no_more_trials_and_returns_no_results() {
    let cancelled = AtomicBool::new(false);
    let begun = AtomicU64::new(0);
    let trial = observing(|_| {
        if begun.fetch_add(1, Ordering::Relaxed) == 99 {
            cancelled.store(true, Ordering::Relaxed);
        }
        observation(0.0, 0.0, None)
    });
    let sweep = Tasks::new(&[1000 * BLOCK; 2], |_| Ok::<_, Infallible>(&trial));
    for threads in [1, 2] {
        begun.store(0, Ordering::Relaxed);
        cancelled.store(false, Ordering::Relaxed);
        let error = streamed(threads, &sweep, &cancelled).unwrap_err();
        assert!(matches!(error, SweepError::Cancelled), "{error}");
        let begun = begun.load(Ordering::Relaxed);
        // If a run is cancelled, a thread stops after its current trial, not after its block. Trial 100 sets the flag
        // that cancels the run. So a single thread starts exactly 100 trials; a second thread may start more before it
        // reads the flag.
        assert!((100..1000 * BLOCK).contains(&begun), "{begun}");
        assert!(threads > 1 || begun == 100, "{begun}");
    }
    cancelled.store(false, Ordering::Relaxed);
    begun.store(100, Ordering::Relaxed);
    assert_eq!(streamed(2, &sweep, &cancelled).unwrap().len(), 2);
}

/// An experiment that counts how many instances of it exist at the same time, and stores the largest number.
struct Alive<'a>(&'a [AtomicU64; 2]);

impl<'a> Alive<'a> {
    fn new(counts: &'a [AtomicU64; 2]) -> Self {
        let alive = 1 + counts[0].fetch_add(1, Ordering::Relaxed);
        counts[1].fetch_max(alive, Ordering::Relaxed);
        Self(counts)
    }
}

impl Drop for Alive<'_> {
    fn drop(&mut self) {
        self.0[0].fetch_sub(1, Ordering::Relaxed);
    }
}

impl Trial for Alive<'_> {
    fn quantities(&self) -> usize {
        1
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        record.observe(0, observation(normal(trial), 0.0, None));
        Ok(())
    }
}

#[test]
fn cells_are_set_up_once_each_and_few_are_alive() {
    const CELLS: usize = 600;
    let trials: Vec<u64> = (0..CELLS as u64).map(|cell| cell % 3 * BLOCK).collect();
    for threads in [1, 2] {
        let counts = [0, 0].map(AtomicU64::new);
        let set_ups = AtomicU64::new(0);
        let set_up = |_| {
            set_ups.fetch_add(1, Ordering::Relaxed);
            Ok::<_, Infallible>(Alive::new(&counts))
        };
        let sweep = Tasks::new(&trials, set_up);
        let cells = streamed(threads, &sweep, &AtomicBool::new(false)).unwrap();
        let trials_of = cells.iter().map(|cell| cell.trials);
        assert!(trials_of.eq(trials.iter().copied()));
        let [alive, most] = counts.map(AtomicU64::into_inner);
        assert_eq!((set_ups.into_inner(), alive), (CELLS as u64, 0));
        // Each thread keeps one experiment in memory. In addition, an experiment is kept while its trials are divided
        // between two jobs. So the number of experiments that exist at the same time is much smaller than the number of
        // cells.
        assert!((1..60).contains(&most), "{most}");
    }
}

#[test]
fn a_cell_that_cannot_be_set_up_ends_the_run() {
    let counts = [0, 0].map(AtomicU64::new);
    let set_up = |cell: usize| match cell {
        70 => Err("off the object"),
        _ => Ok(Alive::new(&counts)),
    };
    let sweep = Tasks::new(&[5; 100], set_up);
    let error = streamed(2, &sweep, &AtomicBool::new(false)).unwrap_err();
    assert!(
        matches!(error, SweepError::SetUp("off the object")),
        "{error}"
    );
    assert_eq!(counts[0].load(Ordering::Relaxed), 0);
}

#[test]
fn nothing_to_do_is_done() {
    assert_eq!(run_with(2, &[]), []);
    let silent = Function {
        quantities: 0,
        function: |_: u64, _: &mut Record| Ok(()),
    };
    let cell = run_cell(2000, &silent);
    assert_eq!(
        (cell.trials, cell.failed(), cell.quantities.len()),
        (2000, 0, 0)
    );
}
