//! Benchmarks of the marker images: projection without pixels, and rendering of frames.
#![allow(missing_docs, clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use palpate_chromatouch::{
    Blemishes, Camera, Colours, DiscDepths, DiscMotion, Discs, Layout, Lens, MarkerArray,
    MarkerMotion, Optics, Seams,
};
use palpate_sensing::{Channel, Stream};

/// Optics of the published sensor. `misalignment` is the largest misalignment of the discs, relative to their diameter.
fn published(size_px: u32, misalignment: f64, blemishes: Blemishes) -> Optics {
    let places = Layout::published().places(20.0).unwrap();
    let discs = Discs {
        magenta: 2.0,
        yellow: 2.0,
    };
    let depths = DiscDepths {
        magenta: 3.0,
        yellow: 1.0,
    };
    let array = MarkerArray::new(20.0, &places, discs, depths).unwrap();
    let array = array.misaligned(misalignment, 1).unwrap();
    let camera = Camera::new(Lens::Fisheye, size_px, 70.0).unwrap();
    Optics::new(array, camera, Colours::default(), blemishes).unwrap()
}

fn motions() -> Vec<Option<MarkerMotion>> {
    let disc = |normal, along| DiscMotion {
        normal,
        tangential: [along, -0.5 * along],
        ..DiscMotion::default()
    };
    let motion = |marker: i32| MarkerMotion {
        magenta: disc(0.4 / f64::from(1 + marker), 0.05),
        yellow: disc(0.6 / f64::from(1 + marker), 0.1),
    };
    (0..77).map(|marker| Some(motion(marker))).collect()
}

fn benches(criterion: &mut Criterion) {
    let motions = motions();
    let noise = Blemishes {
        pixel_std: 2.0,
        ..Blemishes::default()
    };
    let all = Blemishes {
        light_at_rim: 0.5,
        blur_px: 1.0,
        seams: Some(Seams {
            gores: 4,
            width: 0.3,
        }),
        ..noise
    };
    let clean = Blemishes::default();
    for (name, misalignment) in [
        ("projected, 77 markers", 0.3),
        ("projected, 77 markers, aligned", 0.0),
    ] {
        let optics = published(640, misalignment, clean);
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| optics.project(black_box(&motions)).unwrap());
        });
    }
    for (name, size_px, misalignment, blemishes) in [
        ("rendered, 265 px", 265, 0.3, clean),
        ("rendered, 640 px", 640, 0.3, clean),
        ("rendered, 640 px, aligned", 640, 0.0, clean),
        ("rendered, 2048 px", 2048, 0.3, clean),
        ("rendered, 640 px, pixel noise", 640, 0.3, noise),
        ("rendered, 640 px, all blemishes", 640, 0.3, all),
    ] {
        let optics = published(size_px, misalignment, blemishes);
        criterion.bench_function(name, |bencher| {
            bencher.iter(|| {
                let mut stream = Stream::new(1, 0, Channel::Pixel);
                optics
                    .render(black_box(&motions), Some(&mut stream))
                    .unwrap()
            });
        });
    }
}

criterion_group!(optics, benches);
criterion_main!(optics);
