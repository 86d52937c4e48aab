//! Benchmarks of formulas and of curvature at a point.

use std::collections::BTreeMap;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use palpate_geometry::Parameters;
use palpate_geometry::Surface;
use palpate_geometry::formula::Formula;
use palpate_geometry::surfaces::{Ellipsoid, Graph};

const TEXT: &str = "a * sin(2 * x) * cos(2 * y) + x^2 / 8";

fn surfaces(criterion: &mut Criterion) {
    let parameters = BTreeMap::from([("a".to_owned(), 0.2)]);
    criterion.bench_function("formula, parsed", |bencher| {
        bencher.iter(|| Formula::parse(black_box(TEXT), &parameters));
    });
    let formula = Formula::parse(TEXT, &parameters).expect("a formula");
    criterion.bench_function("formula, value", |bencher| {
        bencher.iter(|| formula.value(black_box(0.4), black_box(0.3)));
    });
    criterion.bench_function("formula, first and second derivatives", |bencher| {
        bencher.iter(|| formula.jet(black_box(0.4), black_box(0.3)));
    });
    let saddle = Graph::saddle(0.1).expect("a saddle");
    let ellipsoid = Ellipsoid::new([1.0, 2.0, 3.0]).expect("an ellipsoid");
    let at = Parameters::new(0.4, 0.3);
    criterion.bench_function("curvature of a saddle", |bencher| {
        bencher.iter(|| saddle.chart_geometry(black_box(at)));
    });
    criterion.bench_function("curvature of an ellipsoid", |bencher| {
        bencher.iter(|| ellipsoid.chart_geometry(black_box(at)));
    });
}

criterion_group!(benches, surfaces);
criterion_main!(benches);
