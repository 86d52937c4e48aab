//! The runner as its users see it.
#![allow(clippy::unwrap_used)]

mod any_number;
mod determinism;
mod extremes;
mod order;
mod plan;
mod search;
mod statistics;
mod tasks;

use std::num::NonZeroUsize;

use palpate_sweep::{Cell, CellStatistics, Observation, Record, RunOptions, Runner, Trial, run};

/// A trial made of a function.
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

/// A trial of one quantity that never fails.
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
    let options = RunOptions {
        threads: NonZeroUsize::new(threads),
        ..RunOptions::default()
    };
    run(cells, &options, &|_| ()).expect("a machine that gives threads")
}

fn runner(threads: usize) -> Runner {
    let threads = NonZeroUsize::new(threads);
    Runner::new(&RunOptions {
        threads,
        ..RunOptions::default()
    })
    .expect("a machine that gives threads")
}

fn run_cell(trials: u64, trial: &dyn Trial) -> CellStatistics {
    let mut cells = run_with(2, &[Cell { trials, trial }]);
    assert_eq!(cells.len(), 1);
    cells.remove(0)
}

/// Independent numbers in (0, 1), a function of their index (SplitMix64).
fn uniform(index: u64) -> f64 {
    let mut bits = index.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    ((bits >> 11) as f64 + 0.5) / (1u64 << 53) as f64
}

/// Independent standard normal numbers (Box and Muller).
fn normal(index: u64) -> f64 {
    let (radius, angle) = (uniform(2 * index + 1), uniform(2 * index + 2));
    (-2.0 * libm::log(radius)).sqrt() * libm::cos(std::f64::consts::TAU * angle)
}
