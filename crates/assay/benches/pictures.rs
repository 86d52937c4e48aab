//! Fits of what a camera sees of a press, at 77 markers.
#![allow(missing_docs, unreachable_pub)]

use criterion::{Criterion, criterion_group, criterion_main};
use palpate_assay::workloads::image_fits::{Bodies, Step, half_spaces, layers, workload};

fn pictures(criterion: &mut Criterion) {
    let bodies: [(&str, Bodies); 2] = [("half-space", half_spaces), ("layer", layers)];
    let steps = [
        ("rest", Step::Rest),
        ("fit", Step::Fit),
        ("fit, cold", Step::Cold),
        ("doubts", Step::Misfits),
    ];
    for (body, bodies) in bodies {
        for (name, step) in steps {
            let name = format!("{body}, {name}");
            let mut workload = workload(&name, bodies, step).expect("a press");
            criterion.bench_function(&name, |bencher| {
                bencher.iter(|| workload.run());
            });
        }
    }
}

criterion_group!(benches, pictures);
criterion_main!(benches);
