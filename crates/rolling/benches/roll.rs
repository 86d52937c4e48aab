//! The forward law, rung by rung: a long roll (6 rad) to 1e-12 and a short one (0.1 rad) to 1e-13.
//!
//! Each benchmark first asserts the end-point error that its name claims.
#![allow(missing_docs, clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use palpate_geometry::Shape;
use palpate_geometry::surfaces::{Graph, Sphere};
use palpate_rolling::{Chart, Contact, HeldAxis, Model, Motion, Probe, Roller, Rolls};

fn roller(object: &Shape, model: Model, motion: Motion) -> Roller {
    let rolls = vec![vec![motion]];
    let probe = Probe::new(1.0).unwrap();
    Roller::new(
        probe,
        object.clone(),
        (0.0, 0.0),
        model,
        Rolls { rolls: &rolls },
    )
    .unwrap()
}

fn error(a: &Contact, b: &Contact) -> f64 {
    (a.on_object - b.on_object)
        .amax()
        .max((a.on_probe(1.0) - b.on_probe(1.0)).amax())
}

fn benches(criterion: &mut Criterion) {
    let objects = [
        (
            "sphere",
            Shape::Sphere(Sphere::new(1.0).unwrap()),
            Model::ClosedForm,
        ),
        (
            "paraboloid",
            Shape::Paraboloid(Graph::paraboloid(1.0).unwrap()),
            Model::Meridian,
        ),
    ];
    for (name, object, exact) in &objects {
        for (theta, tolerance, bound) in [(6.0, 1e-12, 1e-12), (0.1, 1e-12, 1e-13)] {
            let motion = Motion::rolling(0.7, 0.1, theta / 0.1);
            let truth = roller(object, *exact, motion).roll(&[motion]).unwrap();
            let charts = [
                ("chart-free", Chart::Free),
                ("montana", Chart::Montana(HeldAxis::Transported)),
            ];
            for (form, chart) in charts {
                let roller = roller(object, Model::Dop853 { tolerance, chart }, motion);
                let Ok(end) = roller.roll(&[motion]) else {
                    continue;
                };
                let off = error(&end, &truth);
                assert!(
                    off <= bound,
                    "{name} {theta} rad, {form}: error {off:e} > {bound:e}"
                );
                criterion.bench_function(
                    &format!("{name} {theta} rad, DOP853 {form}"),
                    |bencher| {
                        bencher.iter(|| roller.roll(black_box(&[motion])).unwrap());
                    },
                );
            }
            let roller = roller(object, *exact, motion);
            criterion.bench_function(
                &format!("{name} {theta} rad, {}", roller.choice().rung),
                |bencher| {
                    bencher.iter(|| roller.shift(black_box(&[motion])).unwrap());
                },
            );
            criterion.bench_function(
                &format!(
                    "{name} {theta} rad, {}, whole contact",
                    roller.choice().rung
                ),
                |bencher| {
                    bencher.iter(|| roller.roll(black_box(&[motion])).unwrap());
                },
            );
        }
    }
}

criterion_group!(roll, benches);
criterion_main!(roll);
