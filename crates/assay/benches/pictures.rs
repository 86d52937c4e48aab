//! Fits of what a camera sees of a press, at 77 markers.
#![allow(missing_docs, unreachable_pub)]

use criterion::{Criterion, criterion_group, criterion_main};
use palpate_assay::hot::pictures::{Step, worked};
use palpate_press::Body;

fn pictures(criterion: &mut Criterion) {
    let half_space = |depth: f64| Ok(Body::half_space(0.5, depth)?);
    let layer = |depth: f64| Ok(Body::bonded_layer(5.0, depth)?);
    let steps = [
        ("rest", Step::Rest),
        ("fit", Step::Fit),
        ("doubts", Step::Doubts),
    ];
    for (name, step) in steps {
        let mut path = worked(half_space, step).expect("a press");
        criterion.bench_function(&format!("half-space, {name}"), |bencher| {
            bencher.iter(&mut path)
        });
        let mut path = worked(layer, step).expect("a press");
        criterion.bench_function(&format!("layer, {name}"), |bencher| bencher.iter(&mut path));
    }
}

criterion_group!(benches, pictures);
criterion_main!(benches);
