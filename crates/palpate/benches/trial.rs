//! A whole trial: draws, rolls, least squares, covariance, and the statistics of the runner.
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use palpate_scene::{RollScene, Scene, config};
use palpate_sweep::{Cell, RunOptions};

#[path = "../src/trial.rs"]
mod trial;

use trial::SceneTrial;

fn scene(object: &str, noise: &str, sensor: &str) -> SceneTrial {
    let text = format!(
        "name = \"bench\"\n[scene]\nkind = \"roll\"\nprobe = {{ kind = \"sphere\", radius = 1.0 }}\n\
         object = {object}\nmotion = {{ rate_rad_per_s = 0.1, duration_s = 1.0 }}\n\
         noise = {{ {noise} }}\nsensor = {sensor}\n"
    );
    SceneTrial(
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
            bencher.iter(|| palpate_sweep::run(&cells, &options, &|_| ()).unwrap());
        });
    }
    group.finish();
    criterion.bench_function("two trials without statistics", |bencher| {
        let trial = scene(sphere, uniform, "{ kind = \"ideal\" }");
        let mut number = 0;
        bencher.iter(|| {
            let Scene::Roll(roll) = &trial.0 else {
                panic!("not a roll");
            };
            let trials = std::array::from_fn(|lane| number + lane as u64);
            number += RollScene::SIDE_BY_SIDE as u64;
            roll.side_by_side(trials).unwrap()
        });
    });
}

criterion_group!(group, benches);
criterion_main!(group);
