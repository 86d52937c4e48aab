//! Benchmarks of the search for markers and of their matching: 77 discs of random hues on a dark ground, with a given
//! image circle, and 61 large markers on a bright ground.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use palpate_testkit as frames;
use palpate_tracking::{Finder, FinderSettings, Mask, match_markers};

fn tracking(criterion: &mut Criterion) {
    for size in [640, 1024] {
        let (frame, _) = frames::dark(size, 11);
        let mut finder = Finder::new(FinderSettings {
            mask: Some(Mask {
                centre_px: [0.5 * size as f64; 2],
                radius_px: 0.48 * size as f64,
            }),
            ..FinderSettings::default()
        })
        .expect("valid settings");
        criterion.bench_function(&format!("find, {size} px, dark"), |bencher| {
            bencher.iter(|| finder.find(black_box(&frame)).expect("markers"));
        });
        let found = finder.find(&frame).expect("markers").markers;
        criterion.bench_function(&format!("match {} markers", found.len()), |bencher| {
            bencher.iter(|| match_markers(black_box(&found), black_box(&found)));
        });
    }
    let how = frames::Bright {
        size: 640,
        disc_px: 32.0,
        apart: 0.3,
        blur_px: 2.0,
        falloff: 0.5,
        noise: 2.0,
    };
    let (frame, _) = frames::bright(how, &frames::rings(640, 56.0, 4), 3);
    let mut finder = Finder::new(FinderSettings::default()).expect("valid settings");
    criterion.bench_function("find, 640 px, bright, 61 large", |bencher| {
        bencher.iter(|| finder.find(black_box(&frame)).expect("markers"));
    });
}

criterion_group!(benches, tracking);
criterion_main!(benches);
