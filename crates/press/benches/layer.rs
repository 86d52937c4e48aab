//! A bonded layer, pressed and read at 77 markers.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use palpate_press::{BondedLayer, LayerContact};

/// Distances like those of markers on a sphere of radius 20.
fn read(contact: &LayerContact) -> f64 {
    (0..77)
        .map(|marker| contact.field(0.25 * f64::from(marker)).normal)
        .sum()
}

fn layer(criterion: &mut Criterion) {
    let layer = || BondedLayer::new(5.0, 2.0).expect("a layer");
    let pressed = layer();
    let radius = |indentation| pressed.contact_radius(indentation).expect("a contact");
    criterion.bench_function("layer, solved and read at 77 markers", |bencher| {
        bencher.iter(|| read(&pressed.solved(radius(black_box(20.0))).expect("a contact")));
    });
    criterion.bench_function("layer, from its table, read at 77 markers", |bencher| {
        bencher.iter(|| read(&pressed.contact(radius(black_box(20.0))).expect("a contact")));
    });
    criterion.bench_function("layer, one table made", |bencher| {
        bencher.iter(|| layer().contact(black_box(6.2)).expect("a contact"));
    });
}

criterion_group!(benches, layer);
criterion_main!(benches);
