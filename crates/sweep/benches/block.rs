//! Benchmark of the cost of one trial in the runner and its statistics. The trials only read numbers from a table, so
//! that almost only the runner's own work is measured. Each trial observes five quantities.

use std::hint::black_box;
use std::num::NonZeroUsize;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use palpate_sweep::{Cell, Observation, Record, RunOptions, Runner, Trial};

const QUANTITIES: usize = 5;
const TRIALS: u64 = 1 << 20;
const TABLE: usize = 1 << 12;

/// A trial that reads its estimates from a table. Their errors are nearly normally distributed.
struct LookUp {
    table: Vec<f64>,
    std: Option<f64>,
}

impl LookUp {
    fn new(std: Option<f64>) -> LookUp {
        let mut state = 1u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        LookUp {
            table: (0..TABLE).map(|_| 5.0 + 0.05 * normal()).collect(),
            std,
        }
    }
}

impl Trial for LookUp {
    fn quantities(&self) -> usize {
        QUANTITIES
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        let start = trial as usize * QUANTITIES;
        for quantity in 0..QUANTITIES {
            let observation = Observation {
                estimate: self.table[(start + quantity) % TABLE],
                truth: 5.0,
                std: self.std,
                interval_holds: None,
            };
            record.observe(quantity, observation);
        }
        Ok(())
    }
}

/// The throughput that criterion reports is the number of trials per second. Its inverse is the cost of a trial.
fn block(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("trial of five quantities");
    group.throughput(Throughput::Elements(TRIALS));
    group.sample_size(20);
    for (name, std) in [("without std", None), ("with std", Some(0.05))] {
        let trial = LookUp::new(std);
        for threads in [1, 2] {
            let options = RunOptions {
                threads: NonZeroUsize::new(threads),
                whole_blocks: true,
            };
            group.bench_function(format!("{name}, {threads} threads"), |bencher| {
                bencher.iter(|| {
                    let cell = Cell {
                        trials: TRIALS,
                        trial: &trial,
                    };
                    let runner = Runner::new(&options);
                    runner.map(|runner| runner.run(black_box(&[cell]), &|_| ()))
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, block);
criterion_main!(benches);
