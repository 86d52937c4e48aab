//! Measures the computing time of the estimator `two-pass` for 30 contacts of three fingers. If the contacts have small
//! errors, the spline has no interior knots; if they have large errors, it needs some.

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Point3, Vector3};
use palpate_ep2::{Contact, Method, Passes, Patch, Status, TwoPass};
use palpate_sensing::{Channel, Stream};
use std::hint::black_box;

const RADIUS: f64 = 5.0;

/// Ten contacts of each of three fingers at y = −1, 0 and 1 on a sphere, with errors of up to `bound`.
fn contacts(bound: f64, trial: u64) -> Vec<Contact> {
    let mut noise = Stream::new(7, trial, Channel::Position);
    let mut contacts = Vec::new();
    for finger in 0..3 {
        for step in 0..10 {
            let (x, y) = (-1.5 + step as f64 / 3.0, finger as f64 - 1.0);
            let z = (RADIUS * RADIUS - x * x - y * y).sqrt();
            let error = Vector3::from_fn(|_, _| bound * noise.symmetric_uniform());
            let position = Point3::new(x, y, z) + error;
            contacts.push(Contact::new(finger, position, Some(Vector3::new(x, y, z))));
        }
    }
    contacts
}

fn patch(contacts: &[Contact]) -> Patch {
    Patch::new(contacts, &Vector3::z()).expect("contacts of a sphere")
}

fn two_pass(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("two-pass");
    let both = TwoPass::default();
    let first = TwoPass {
        passes: Passes::One,
        ..both
    };
    let few = contacts(0.05, 0);
    let smooth = patch(&few);
    let fitted = both.fit(&smooth).expect("a polynomial");
    assert_eq!(fitted.status, Some(Status::Polynomial));
    let mean = fitted
        .curvature_at(&Point3::new(0.0, 0.0, RADIUS))
        .expect("a curvature")
        .mean;
    assert!((mean * RADIUS - 1.0).abs() < 0.2, "{mean}");
    group.bench_function("first pass, 30 contacts, no knots", |bencher| {
        bencher.iter(|| first.fit(black_box(&smooth)));
    });
    group.bench_function("both passes, 30 contacts, no knots", |bencher| {
        bencher.iter(|| both.fit(black_box(&smooth)));
    });
    group.bench_function("both passes and a 30 x 30 map, 30 contacts", |bencher| {
        bencher.iter(|| {
            both.fit(black_box(&smooth))
                .and_then(|fit| fit.curvatures(30))
        });
    });
    let rough = TwoPass {
        smoothing: 250.0,
        ..both
    };
    let noisy = patch(&contacts(0.1, 0));
    let first_of_rough = TwoPass {
        passes: Passes::One,
        ..rough
    };
    let fitted = first_of_rough.fit(&noisy).expect("a spline");
    assert_eq!(fitted.status, Some(Status::Smoothing));
    group.bench_function("both passes, 30 contacts, knots", |bencher| {
        bencher.iter(|| rough.fit(black_box(&noisy)));
    });
    group.finish();
}

criterion_group!(benches, two_pass);
criterion_main!(benches);
