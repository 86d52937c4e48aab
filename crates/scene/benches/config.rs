//! Measures the time in which the text of a config is parsed and its scenes are built.

use palpate_scene::Scenes;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use palpate_study::config;

const TEXT: &str = include_str!("../../../examples/press-a-ball.toml");

fn configs(criterion: &mut Criterion) {
    criterion.bench_function("parse a config and expand its sweeps", |bencher| {
        bencher.iter(|| config::parse("press-a-ball.toml", black_box(TEXT)));
    });
    let study = config::parse("press-a-ball.toml", TEXT).expect("a config");
    criterion.bench_function("scene of a cell", |bencher| {
        bencher.iter(|| study.scene(black_box(0)));
    });
}

criterion_group!(benches, configs);
criterion_main!(benches);
