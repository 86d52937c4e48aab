//! Measures how much longer a run takes if it writes a journal of its results. The same study runs twice: once without
//! a journal (the rows of the journal are made and dropped), and once with a journal. The journal is written to the
//! disk once, at the end of the run. On a busy machine, times that were measured minutes apart cannot be compared.
//! Therefore, the two runs of a pair follow each other directly, and the printed ratio is the median over the pairs.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

// The journal belongs to the program `palpate`, which a bench cannot import. Therefore its source files are included
// here.
#[allow(dead_code, unused_imports)]
#[path = "../src/bin/palpate/failure.rs"]
mod failure;
#[allow(dead_code)]
#[path = "../src/bin/palpate/journal.rs"]
mod journal;
#[path = "../src/bin/palpate/output"]
mod output {
    #[allow(dead_code)]
    pub(crate) mod names;
}

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use journal::{CellRecord, Header, Journal, RunRequest};
use palpate::{RunOptions, Runner, Simulation, Study, SweepOutput, Warnings};

/// A study of rolls on balls of different radii. Its trials are fast, because a formula gives the path of the contact.
fn study(cells: u64, trials: u64) -> Study {
    let text = format!(
        "name = \"bench\"\nlength_unit = \"mm\"\ntrials = {trials}\n[scene]\nkind = \"roll\"\n\
         probe = {{ kind = \"sphere\", radius = 10.0 }}\nobject = {{ kind = \"sphere\", radius = 30.0 }}\n\
         motion = {{ rate_rad_per_s = 0.1, duration_s = 1.0 }}\n\
         noise = {{ angular_velocity = {{ kind = \"uniform\", fraction = 0.05 }} }}\n\
         [[sweep]]\npath = \"scene.object.radius\"\nfrom = 20.0\nto = 200.0\ncount = {cells}\n"
    );
    palpate::parse("bench.toml", &text).unwrap()
}

fn bare(simulation: &Simulation<'_>) -> usize {
    let mut bytes = 0;
    let made = |finished| simulation.rows(&finished);
    let take = &mut |_, taken| {
        if let SweepOutput::Result(rows) = taken {
            let rows: palpate::CellRows = rows;
            bytes += rows.cells.len();
        }
        ControlFlow::Continue(())
    };
    let cancelled = AtomicBool::new(false);
    simulation
        .stream(0, &cancelled, &|_| (), made, take)
        .unwrap();
    bytes
}

fn journalled(simulation: &Simulation<'_>, dir: &Path) {
    let request = RunRequest {
        config: String::new(),
        goal: String::new(),
        every_nth_cell: 1,
        shard: None,
        trials_out: false,
    };
    let tasks = [simulation.tasks(); 2];
    let header = Header::new(String::new(), request, Warnings::default(), tasks);
    let mut journal = Journal::new(dir, &header).unwrap();
    let made = |results: palpate::CellResults| {
        let rows = simulation.rows(&results);
        CellRecord::new(results.cell, rows)
    };
    let take = &mut |_, taken| {
        if let SweepOutput::Result(record) = taken {
            journal.cell(record).unwrap();
        }
        ControlFlow::Continue(())
    };
    let cancelled = AtomicBool::new(false);
    simulation
        .stream(0, &cancelled, &|_| (), made, take)
        .unwrap();
    journal.end().unwrap();
}

/// Median, over pairs of runs, of the run time with a journal divided by the run time without a journal.
fn ratio(simulation: &Simulation<'_>, dir: &Path) -> f64 {
    const PAIRS: usize = 15;
    let time = |run: &dyn Fn()| {
        // Delete the old journal before the clock starts.
        let _ = std::fs::remove_file(dir.join(output::names::JOURNAL));
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    let bare = || assert!(bare(simulation) > 0);
    let journalled = || journalled(simulation, dir);
    let pair = |number| match number % 2 {
        0 => time(&bare).recip() * time(&journalled),
        _ => time(&journalled) / time(&bare),
    };
    let mut ratios: Vec<f64> = (0..PAIRS).map(pair).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[PAIRS / 2]
}

fn benches(criterion: &mut Criterion) {
    let runner = Runner::new(&RunOptions::default()).unwrap();
    // Use the disk of the target directory, because a temporary directory may be in memory.
    let dir = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let mut group = criterion.benchmark_group("journal");
    group.sample_size(10);
    for (name, cells, trials) in [("light cells", 30_000, 100), ("heavy cells", 40, 300_000)] {
        let study = study(cells, trials);
        let numbers = 0..study.cell_count();
        let simulation = Simulation::new(&study, numbers, &runner).unwrap();
        group.throughput(Throughput::Elements(cells));
        group.bench_function(format!("{name}, bare"), |bencher| {
            bencher.iter(|| bare(&simulation));
        });
        group.bench_function(format!("{name}, with a journal"), |bencher| {
            bencher.iter(|| journalled(&simulation, dir.path()));
        });
        if std::env::args().any(|argument| argument == "--bench") {
            let ratio = ratio(&simulation, dir.path());
            println!("journal/{name}: {ratio:.3} of the time of the bare loop");
        }
    }
    group.finish();
}

criterion_group!(group, benches);
criterion_main!(group);
