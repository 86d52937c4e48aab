//! Times all workloads of palpate.

use criterion::Criterion;
use palpate_assay::workloads;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    for name in workloads::names() {
        criterion.bench_function(name, |bencher| {
            let mut evaluation = workloads::evaluation(name).expect("a workload");
            bencher.iter(|| evaluation.run());
        });
    }
    criterion.final_summary();
}
