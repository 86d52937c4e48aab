//! Benchmarks of the least-squares fit for eight probes on a sphere. One benchmark measures the whole computation from
//! the readings to an estimate. The other measures only the part that depends on the rotations.

use std::f64::consts::FRAC_PI_4;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Vector2;
use palpate_ep1::{LeastSquares, ProbeReading, ReadingNoise};

const RADIUS: f64 = 1.0;
const SPHERE: f64 = 5.0;

/// Readings of eight probes. Each probe turns by 0.1 rad in a different direction.
fn readings() -> Vec<ProbeReading> {
    let reading = |probe: i32| {
        let (sine, cosine) = libm::sincos(FRAC_PI_4 * f64::from(probe));
        let along = 0.1 / (1.0 / RADIUS + 1.0 / SPHERE);
        ProbeReading {
            rotation: Vector2::new(0.1 * sine, -0.1 * cosine),
            shift: Vector2::new(along * cosine, along * sine),
        }
    };
    (0..8).map(reading).collect()
}

fn fit(criterion: &mut Criterion) {
    let readings = readings();
    let noise = ReadingNoise {
        relative_rotation_std: 0.01,
        ..ReadingNoise::default()
    };
    let estimate = LeastSquares::of(RADIUS, noise, &readings).expect("an estimate");
    assert!((estimate.mean_curvature.value * SPHERE - 1.0).abs() < 1e-12);
    criterion.bench_function("eight probes, readings to estimate", |bencher| {
        bencher.iter(|| LeastSquares::of(RADIUS, noise, black_box(&readings)));
    });
    let rotations: Vec<_> = readings.iter().map(|reading| reading.rotation).collect();
    criterion.bench_function("eight probes, set up", |bencher| {
        bencher.iter(|| LeastSquares::new(RADIUS, noise, black_box(&rotations)));
    });
}

criterion_group!(benches, fit);
criterion_main!(benches);
