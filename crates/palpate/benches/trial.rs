//! Measures the time of a whole trial: random numbers, rolls, least-squares fit, covariance, and the runner's
//! statistics.
#![allow(missing_docs, clippy::unwrap_used)]

use palpate_scene::Scenes;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use palpate::{Scene, SceneTrial, config};
use palpate_sweep::{Cell, RunOptions, Runner};

fn scene(object: &str, noise: &str, sensor: &str) -> SceneTrial {
    let text = format!(
        "name = \"bench\"\n[scene]\nkind = \"roll\"\nprobe = {{ kind = \"sphere\", radius = 1.0 }}\n\
         object = {object}\nmotion = {{ rate_rad_per_s = 0.1, duration_s = 1.0 }}\n\
         noise = {{ {noise} }}\nsensor = {sensor}\n"
    );
    SceneTrial::new(
        config::parse("bench.toml", &text)
            .unwrap()
            .scene(0)
            .unwrap(),
    )
}

fn benches(criterion: &mut Criterion) {
    const TRIALS: u64 = 1 << 17;
    let uniform = "angular_velocity = { kind = \"uniform\", fraction = 0.01 }";
    let sphere = "{ kind = \"sphere\", radius = 5.0 }";
    let cases = [
        ("closed form", sphere, uniform, "{ kind = \"ideal\" }"),
        (
            "meridian",
            "{ kind = \"paraboloid\", c = 1.0 }",
            uniform,
            "{ kind = \"ideal\" }",
        ),
        (
            "integrated",
            "{ kind = \"saddle\", a = 0.1 }",
            uniform,
            "{ kind = \"ideal\" }",
        ),
        (
            "square pads",
            sphere,
            "",
            "{ kind = \"pads\", pitch = 0.01, offset = \"random\" }",
        ),
        (
            "uniform pads",
            sphere,
            "",
            "{ kind = \"pads\", pitch = 0.01, layout = \"uniform\", offset = \"random\" }",
        ),
        ("wrist", sphere, "", "{ kind = \"wrist\", std = 0.01 }"),
    ];
    let options = RunOptions {
        threads: std::num::NonZeroUsize::new(1),
        whole_blocks: true,
    };
    let mut group = criterion.benchmark_group("trial");
    group.throughput(Throughput::Elements(TRIALS));
    group.sample_size(10);
    for (name, object, noise, sensor) in cases {
        let trial = scene(object, noise, sensor);
        group.bench_function(name, |bencher| {
            let cells = [Cell {
                trials: TRIALS,
                trial: &trial,
            }];
            bencher.iter(|| Runner::new(&options).unwrap().run(&cells, &|_| ()));
        });
    }
    group.finish();
    let mut group = criterion.benchmark_group("trial without statistics");
    group.throughput(Throughput::Elements(TRIALS));
    group.bench_function("sphere", |bencher| {
        let trial = scene(sphere, uniform, "{ kind = \"ideal\" }");
        let Scene::Roll(roll) = &trial.scene else {
            panic!("not a roll");
        };
        bencher.iter(|| {
            roll.side_by_side(palpate::Arch::new(), 0..TRIALS, |observed| {
                black_box(observed)[0].estimates.len()
            })
        });
    });
    group.finish();
}

criterion_group!(group, benches);
criterion_main!(group);
