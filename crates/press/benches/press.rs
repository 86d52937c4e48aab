//! Presses of the published sensor: 77 markers 2 mm under a skin of radius 20 mm.

use std::f64::consts::FRAC_PI_2;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use palpate_press::{Body, ForwardFit, Markers, Measured, Reading, Skin};
use palpate_sensing::{Channel, Stream};

const NORMAL_STD: f64 = 0.07;
const TANGENTIAL_STD: f64 = 0.05;

fn published() -> Markers {
    let mut positions = vec![[0.0, 0.0]];
    for gore in 0..4 {
        for (row, count) in [1, 3, 3, 5, 7].into_iter().enumerate() {
            let distance = 20.0 * (11.9 * (row + 1) as f64).to_radians();
            for marker in 0..count {
                let share = (f64::from(marker) + 0.5) / f64::from(count);
                let (sine, cosine) = libm::sincos(FRAC_PI_2 * (f64::from(gore) + share));
                positions.push([distance * cosine, distance * sine]);
            }
        }
    }
    Markers::new(Skin::new(20.0).expect("a length"), &positions).expect("finite")
}

fn presses(criterion: &mut Criterion) {
    let markers = published();
    let body = Body::half_space(0.5, 2.0).expect("in range");
    let at = [1.5, 1.0];
    let ball = markers
        .skin()
        .contact(&body, 1.0 / 80.0, 1.0)
        .expect("a contact");
    criterion.bench_function("77 markers, half-space", |bencher| {
        bencher.iter(|| markers.displacements(black_box(&ball), black_box(at)));
    });

    let mut stream = Stream::new(1, 1, Channel::Position);
    let moved = markers.displacements(&ball, at);
    let mut noisy = |value: f64, std: f64| value + std * stream.standard_normal();
    let normal: Vec<f64> = moved
        .iter()
        .map(|moved| noisy(moved.normal, NORMAL_STD))
        .collect();
    let tangential: Vec<[f64; 2]> = moved
        .iter()
        .map(|moved| moved.tangential.map(|along| noisy(along, TANGENTIAL_STD)))
        .collect();
    let fit = ForwardFit {
        normal_std: Some(NORMAL_STD),
        tangential_std: Some(TANGENTIAL_STD),
        ..ForwardFit::new(body.clone())
    };
    let known = Measured {
        value: 1.0,
        std: 0.02,
    };
    for (name, indentation, along) in [
        ("fit, indentation known", Some(known), None),
        ("fit, indentation fitted", None, None),
        ("fit, tangential too", None, Some(tangential.as_slice())),
    ] {
        let reading = Reading {
            markers: &markers,
            normal: &normal,
            tangential: along,
            indentation,
        };
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| fit.estimate(black_box(&reading)).expect("an estimate"));
        });
    }
}

criterion_group!(benches, presses);
criterion_main!(benches);
