//! Measures the computing time of the penalised spline in two cases: the 30 contacts of the 1996 paper, with a map of
//! the curvatures and their standard errors; and many contacts on a detailed surface. Each result is checked before it
//! is timed.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::{Point3, Vector3};
use palpate_ep2::{Contact, Fit, Method, Patch, Penalised, Quadric};
use palpate_sensing::{Channel, Stream};

/// Three fingers with ten contacts each on a sphere of radius 5. Positions have errors of 5 % of the distance between
/// fingers, and normals have errors of 2 degrees.
fn sphere() -> Vec<Contact> {
    let mut stream = Stream::new(1, 0, Channel::Position);
    let mut error = |std: f64| Vector3::from_fn(|_, _| std * stream.standard_normal());
    (0..30)
        .map(|index| {
            let (finger, step) = (index / 10, index % 10);
            let (x, y) = (-1.5 + step as f64 / 3.0, -1.5 + 1.5 * finger as f64);
            let radial = Vector3::new(x, y, (25.0 - x * x - y * y).sqrt());
            let position = Point3::from(radial) + error(0.05);
            let normal = radial.normalize() + error(2.0_f64.to_radians());
            Contact::new(finger, position, Some(normal))
        })
        .collect()
}

/// Contacts at random places on the surface z = 0.2 sin 2x cos 2y, with errors of 0.02 in the heights.
fn waves(contacts: usize) -> Vec<Contact> {
    let mut stream = Stream::new(2, 0, Channel::Position);
    (0..contacts)
        .map(|_| {
            let (x, y) = (
                1.5 * stream.symmetric_uniform(),
                1.5 * stream.symmetric_uniform(),
            );
            let z = 0.2 * libm::sin(2.0 * x) * libm::cos(2.0 * y) + 0.02 * stream.standard_normal();
            Contact::new(0, Point3::new(x, y, z), None)
        })
        .collect()
}

fn patch(contacts: &[Contact]) -> Patch {
    Patch::new(contacts, &Vector3::z()).expect("a patch")
}

fn error_of_waves(fit: &Fit) -> f64 {
    let mut square = 0.0;
    for index in 0..400 {
        let (x, y) = (
            -1.0 + (index / 20) as f64 * 0.1,
            -1.0 + (index % 20) as f64 * 0.1,
        );
        let (z, p, q, s) = (
            0.2 * libm::sin(2.0 * x) * libm::cos(2.0 * y),
            0.4 * libm::cos(2.0 * x) * libm::cos(2.0 * y),
            -0.4 * libm::sin(2.0 * x) * libm::sin(2.0 * y),
            -0.8 * libm::cos(2.0 * x) * libm::sin(2.0 * y),
        );
        let (r, t) = (-4.0 * z, -4.0 * z);
        let d = 1.0 + p * p + q * q;
        let mean =
            -((1.0 + q * q) * r - 2.0 * p * q * s + (1.0 + p * p) * t) / (2.0 * libm::pow(d, 1.5));
        let found = fit
            .curvature_at(&Point3::new(x, y, z))
            .expect("a curvature");
        square += (found.mean - mean).powi(2) / 400.0;
    }
    square.sqrt()
}

fn few(criterion: &mut Criterion) {
    let contacts = sphere();
    let mut group = criterion.benchmark_group("30 contacts");
    let whole = |method: &dyn Method| {
        let fit = method.fit(&patch(&contacts)).expect("a fit");
        fit.curvatures(30).expect("a map")
    };
    let penalised = Penalised::default();
    for curvature in whole(&penalised) {
        let told = curvature.uncertainty.expect("an uncertainty");
        assert!((curvature.mean - 0.2).abs() < 0.06 && told.mean_std < 0.05);
    }
    group.bench_function("penalised, 30 x 30 map with deviations", |bencher| {
        bencher.iter(|| black_box(whole(black_box(&penalised))));
    });
    group.bench_function("penalised, fit", |bencher| {
        let patch = patch(&contacts);
        bencher.iter(|| black_box(penalised.fit(black_box(&patch))));
    });
    group.bench_function("quadric, 30 x 30 map with deviations", |bencher| {
        bencher.iter(|| black_box(whole(black_box(&Quadric::default()))));
    });
    group.finish();
}

fn many(criterion: &mut Criterion) {
    let method = Penalised {
        intervals: Some(6),
        ..Penalised::default()
    };
    let mut group = criterion.benchmark_group("6 x 6 intervals");
    group.sample_size(10);
    for contacts in [10_000, 100_000, 1_000_000] {
        let patch = patch(&waves(contacts));
        let error = error_of_waves(&method.fit(&patch).expect("a fit"));
        assert!(error < 0.1, "{contacts} contacts: {error}");
        group.bench_function(BenchmarkId::from_parameter(contacts), |bencher| {
            bencher.iter(|| black_box(method.fit(black_box(&patch))));
        });
    }
    group.finish();
}

criterion_group!(benches, few, many);
criterion_main!(benches);
