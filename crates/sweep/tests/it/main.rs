//! Integration tests of the runner of sweeps.
#![allow(clippy::unwrap_used)]

mod any_number;
mod cache;
mod determinism;
mod extremes;
mod inverse_quantities;
mod order;
mod statistics;
mod tasks;

use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

use palpate_sweep::{
    Cell, CellStatistics, Observation, Record, RunOptions, Runner, StoppingRule, Sweep, SweepError,
    SweepOutput, Task, Trial,
};

/// Number of trials in a block, the smallest group of trials that is computed together.
pub(crate) const BLOCK: u64 = 1024;

struct Function<F> {
    quantities: usize,
    function: F,
}

impl<F> Trial for Function<F>
where
    F: Fn(u64, &mut Record) -> Result<(), &'static str> + Sync,
{
    fn quantities(&self) -> usize {
        self.quantities
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        (self.function)(trial, record)
    }
}

fn observing(observe: impl Fn(u64) -> Observation + Sync) -> impl Trial {
    Function {
        quantities: 1,
        function: move |trial, record: &mut Record| {
            record.observe(0, observe(trial));
            Ok(())
        },
    }
}

fn observation(estimate: f64, truth: f64, std: Option<f64>) -> Observation {
    Observation {
        estimate,
        truth,
        std,
        interval_holds: None,
    }
}

fn run_with(threads: usize, cells: &[Cell]) -> Vec<CellStatistics> {
    runner(threads).run(cells, &|_| ())
}

fn runner(threads: usize) -> Runner {
    let threads = NonZeroUsize::new(threads);
    Runner::new(&RunOptions {
        threads,
        ..RunOptions::default()
    })
    .expect("threads can be started")
}

fn run_cell(trials: u64, trial: &dyn Trial) -> CellStatistics {
    let mut cells = run_with(2, &[Cell { trials, trial }]);
    assert_eq!(cells.len(), 1);
    cells.remove(0)
}

struct Tasks<F> {
    tasks: Vec<Task>,
    set_up: F,
    rule: Option<StoppingRule>,
}

impl<F> Tasks<F> {
    /// One task for each entry of `trials`. The entry is the number of trials of the task.
    fn new(trials: &[u64], set_up: F) -> Self {
        let task = |(cell, &trials)| Task {
            cell,
            trials,
            may_stop: false,
        };
        Self {
            tasks: trials.iter().enumerate().map(task).collect(),
            set_up,
            rule: None,
        }
    }
}

impl<T: Trial + Send, E: Send, F: Fn(usize) -> Result<T, E> + Sync> Sweep for Tasks<F> {
    type Trial = T;
    type Result = CellStatistics;
    type Error = E;

    fn tasks(&self) -> u64 {
        self.tasks.len() as u64
    }

    fn task(&self, number: u64) -> Task {
        self.tasks[number as usize]
    }

    fn set_up(&self, cell: usize) -> Result<T, E> {
        (self.set_up)(cell)
    }

    fn stopping_rule(&self, _trial: &T) -> Option<StoppingRule> {
        self.rule
    }

    fn finish(&self, _cell: usize, _trial: &T, statistics: CellStatistics) -> CellStatistics {
        statistics
    }
}

/// Returns the results of all tasks. Checks that they arrive in the order of the tasks.
fn streamed<S: Sweep<Result = CellStatistics>>(
    threads: usize,
    sweep: &S,
    cancelled: &AtomicBool,
) -> Result<Vec<CellStatistics>, SweepError<S::Error>> {
    let mut all = Vec::new();
    let mut take = |number, output| {
        assert_eq!(number, all.len() as u64);
        if let SweepOutput::Result(cell) = output {
            all.push(cell);
        }
        ControlFlow::Continue(())
    };
    runner(threads).stream(sweep, cancelled, &|_| (), &mut take)?;
    Ok(all)
}

/// Uniform random number in (0, 1) for an index (SplitMix64). The numbers for different indices are independent.
fn uniform(index: u64) -> f64 {
    let mut bits = index.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    ((bits >> 11) as f64 + 0.5) / (1u64 << 53) as f64
}

/// Standard normal random number for an index (Box–Muller method). The numbers for different indices are independent.
fn normal(index: u64) -> f64 {
    let (radius, angle) = (uniform(2 * index + 1), uniform(2 * index + 2));
    (-2.0 * libm::log(radius)).sqrt() * libm::cos(std::f64::consts::TAU * angle)
}
