//! Measures the computing time of a reading of a pad array, and of random noise.
#![allow(missing_docs, clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Vector2;
use palpate_sensing::{
    AngularVelocityError, Channel, Distribution, PadLayout, PadOffset, Pads, Stream,
};

fn benches(criterion: &mut Criterion) {
    let displacement = Vector2::new(2.3, 1.1);
    for layout in [PadLayout::Square, PadLayout::Uniform] {
        let pads = Pads::new(10.0, 0.1, layout, PadOffset::Random, 1.5).unwrap();
        let placement = pads.place(&mut Stream::new(1, 0, Channel::PadOffset));
        criterion.bench_function(&format!("{layout:?} pads, one reading"), |bencher| {
            bencher.iter(|| pads.read(&placement, black_box(&displacement)).unwrap());
        });
    }
    for distribution in [Distribution::Uniform, Distribution::Gaussian] {
        let error = AngularVelocityError::new(distribution, 0.01).unwrap();
        let mut trial = 0;
        criterion.bench_function(
            &format!("{distribution:?} error of eight probes"),
            |bencher| {
                bencher.iter(|| {
                    trial += 1;
                    let mut stream = Stream::new(7, trial, Channel::AngularVelocity);
                    (0..8).map(|_| error.draw(&mut stream, 0.1).x).sum::<f64>()
                });
            },
        );
    }
}

criterion_group!(pads, benches);
criterion_main!(pads);
