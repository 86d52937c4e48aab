//! `palpate run`.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use anyhow::anyhow;
use palpate::config::Output;
use palpate::{CellStatistics, Map, RunOptions, Runner, Simulation, Study, load, refuse};

use crate::cli::RunArgs;
use crate::failure::Failure;
use crate::output::names::{
    CELLS, CONFIG, FAILURES, FRAMES, MAP, MARKERS, NEXT_CONFIG, READINGS, TRACE, WARNINGS,
};
use crate::output::{Folder, Guard, Owned, StudyId};
use crate::{budget, output, progress, trace};

/// More threads than this only cost their setting up.
const MOST_THREADS: NonZeroUsize = NonZeroUsize::MIN.saturating_add(255);

pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let mut study = load(&args.config).map_err(Failure::usage)?;
    if let Some(seed) = args.seed {
        study.override_seed(seed).map_err(Failure::usage)?;
    }
    if let Some(trials) = args.trials {
        study
            .override_trials(trials.get())
            .map_err(Failure::usage)?;
    }
    refuse(&study).map_err(Failure::usage)?;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out").join(&study.config.name));
    let guard = Guard::new([&args.config], args.force);
    let tables = tables_of(&study);
    // Before the planning, and once more when no other process writes there.
    let refuse = |owned: &Owned, config: &str| {
        owned.refuse(CONFIG, Some(config.as_bytes()))?;
        tables.iter().try_for_each(|name| owned.refuse(name, None))
    };
    refuse(&Owned::read(&out, guard.clone())?, &trace::resolved(&study))?;
    let numbers: Vec<usize> = (0..study.cell_count())
        .step_by(args.every_nth_cell.get())
        .collect();
    let allowed = budget::choose(&study, &numbers, args, start)?;
    let said = allowed.map(|allowed| {
        study = allowed.study;
        (allowed.lines, allowed.warnings)
    });
    let runner = Runner::new(&RunOptions {
        threads: args.threads.map(|threads| threads.min(MOST_THREADS)),
    })
    .map_err(Failure::work)?;
    let first = numbers[0];
    let simulation = Simulation::new(&study, numbers, &runner).map_err(Failure::usage)?;

    let mut folder = Folder::open(&out, guard)?;
    let config = trace::resolved(&study);
    refuse(folder.owned(), &config)?;
    // Before the work, which would be lost where there is no pass to follow.
    let traced = study.config.outputs.contains(&Output::Trace);
    let traced = traced
        .then(|| {
            let trace = palpate::trace(&study, first, None).map_err(trace::refused)?;
            trace::files(&trace)
        })
        .transpose()?;
    let of_study = StudyId::new(&study.config.name, &config);
    folder.begin(&config, &of_study)?;
    let told = simulation.warnings();
    told.iter().for_each(|line| eprintln!("{line}"));
    if let Some((lines, warnings)) = said {
        for warning in warnings {
            eprintln!("warning: {warning}");
        }
        output::print(&lines.join("\n"))?;
    }
    let bar = progress::bar(simulation.trials());
    let ran = simulation
        .run(&AtomicBool::new(false), &|finished| bar.inc(finished))
        .map_err(Failure::of_sweep)?;
    bar.finish_and_clear();

    let mut files: Vec<(&str, Vec<u8>)> = vec![
        (CELLS, ran.cells.to_csv().into()),
        (FAILURES, ran.failures.to_csv().into()),
        (CONFIG, config.into()),
    ];
    files.extend(traced.into_iter().flatten());
    if let Some(map) = &ran.map {
        warn_of_missing(map);
        files.push((MAP, map.table.to_csv().into()));
    }
    if !told.is_empty() {
        files.push((WARNINGS, (told.join("\n") + "\n").into()));
    }
    let written = folder.replace(&files, &of_study);
    let ended = folder.end();
    for line in written? {
        eprintln!("note: {line}");
    }
    ended?;
    let summary = summary(&study, &ran.statistics, &out);
    let mut cells = ran.statistics.iter();
    if cells.all(|cell| failed(cell) == cell.trials) {
        return Err(Failure::work(anyhow!("every trial failed: {summary}")));
    }
    output::print(&summary)
}

/// Number of the trials of a cell that failed.
fn failed(cell: &CellStatistics) -> u64 {
    cell.failures.iter().map(|failure| failure.count).sum()
}

/// All that a run of the study may write besides its config.
fn tables_of(study: &Study) -> Vec<&'static str> {
    let mut names = vec![NEXT_CONFIG, CELLS, FAILURES, WARNINGS];
    if study.config.outputs.contains(&Output::Trace) {
        names.extend([TRACE, READINGS, MARKERS]);
        names.extend(FRAMES);
    }
    if study.config.outputs.contains(&Output::Map) {
        names.push(MAP);
    }
    names
}

/// Says which cells have no map: a trial that fails has none.
fn warn_of_missing(map: &Map) {
    if map.failed.is_empty() {
        return;
    }
    let cells = map.failed.iter();
    let cells: Vec<String> = cells
        .map(|(cell, name)| format!("{cell} ({name})"))
        .collect();
    let (lacks, cells) = (map.lacks, cells.join(", "));
    eprintln!("warning: map.csv lacks {lacks} whose trial 0 failed: {cells}");
}

fn summary(study: &Study, ran: &[CellStatistics], out: &Path) -> String {
    let trials: u64 = ran.iter().map(|cell| cell.trials).sum();
    let mut kinds = std::collections::BTreeMap::new();
    for failure in ran.iter().flat_map(|cell| &cell.failures) {
        *kinds.entry(failure.kind).or_insert(0) += failure.count;
    }
    let failed: u64 = kinds.values().sum();
    let kinds: Vec<String> = kinds
        .iter()
        .map(|(kind, count)| format!("{kind} {count}"))
        .collect();
    let kinds = if failed > 0 {
        format!(" ({})", kinds.join(", "))
    } else {
        String::new()
    };
    format!(
        "{}: {} cells, {trials} trials, {failed} failed{kinds} -> {}",
        study.config.name,
        ran.len(),
        out.display()
    )
}
