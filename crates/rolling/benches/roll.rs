//! Measures the computing time of the models that compute rolls. The error of the last contact may be at most 1e-12 for
//! a long roll (6 rad), and at most 1e-13 for a short roll (0.1 rad).
//!
//! Before an integrator is timed, its error is compared with this bound. Each integrator uses the largest tolerance for
//! which its error is within the bound.
#![allow(missing_docs, clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use palpate_geometry::Shape;
use palpate_geometry::surfaces::{Graph, Sphere};
use palpate_rolling::{Chart, Contact, HeldAxis, Model, Motion, Probe, Roller, Rolls};

const RADIUS: f64 = 1.0;

struct Case {
    object: Shape,
    theta_rad: f64,
    /// Largest allowed error of each coordinate of the last contact, on the object and on the probe.
    bound: f64,
    /// Tolerances of DOP853 for the chart-free equations and for the equations in charts.
    tolerances: [f64; 2],
}

fn cases() -> [Case; 4] {
    let case = |object: &Shape, theta_rad, bound, tolerances| Case {
        object: object.clone(),
        theta_rad,
        bound,
        tolerances,
    };
    let sphere = Shape::Sphere(Sphere::new(1.0).unwrap());
    let paraboloid = Shape::Paraboloid(Graph::paraboloid(1.0).unwrap());
    [
        case(&sphere, 6.0, 1e-12, [1e-11, 1e-12]),
        case(&paraboloid, 6.0, 1e-12, [1e-10, 1e-12]),
        case(&sphere, 0.1, 1e-13, [1e-10, 1e-10]),
        case(&paraboloid, 0.1, 1e-13, [1e-10, 1e-10]),
    ]
}

fn error(a: &Contact, b: &Contact) -> f64 {
    let on_object = (a.on_object - b.on_object).amax();
    on_object.max((a.on_probe(RADIUS) - b.on_probe(RADIUS)).amax())
}

fn benches(criterion: &mut Criterion) {
    for case in cases() {
        let motion = Motion::rolling(0.7, 0.1, case.theta_rad / 0.1);
        let rolls = [vec![motion]];
        let roller = |model| {
            let probe = Probe::new(RADIUS).unwrap();
            let rolls = Rolls::exact(&rolls);
            Roller::new(probe, case.object.clone(), (0.0, 0.0), model, rolls).unwrap()
        };
        let name = format!("{} {} rad", case.object.name(), case.theta_rad);

        // The cheapest exact model: the closed-form model or, if the object has none, the meridian model.
        let exact = roller(Model::Auto {
            tolerance: 1e-13,
            chart: Chart::Free,
        });
        let truth = exact.roll(&[motion]).unwrap();
        let rung = &exact.choice().rung;
        criterion.bench_function(&format!("{name}, {rung}, shift"), |bencher| {
            bencher.iter(|| exact.shift(black_box(&[motion])));
        });
        criterion.bench_function(&format!("{name}, {rung}, contact"), |bencher| {
            bencher.iter(|| exact.roll(black_box(&[motion])));
        });

        let charts = [Chart::Free, Chart::Montana(HeldAxis::Transported)];
        for (chart, tolerance) in charts.into_iter().zip(case.tolerances) {
            let integrated = roller(Model::Dop853 { tolerance, chart });
            let rung = &integrated.choice().rung;
            let off = error(&integrated.roll(&[motion]).unwrap(), &truth);
            assert!(off <= case.bound, "{name}, {rung}: error {off:e}");
            criterion.bench_function(&format!("{name}, {rung}"), |bencher| {
                bencher.iter(|| integrated.roll(black_box(&[motion])));
            });
        }
    }
}

criterion_group!(roll, benches);
criterion_main!(roll);
