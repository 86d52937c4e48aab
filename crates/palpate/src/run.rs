//! `palpate run`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use palpate_scene::config::{self, Output, Study, StudyConfig};
use palpate_scene::glide::MapTable;
use palpate_scene::{Scene, Table};
use palpate_sweep::{Cell, RunOptions};

use crate::cli::RunArgs;
use crate::failure::Failure;
use crate::tables::{self, Ran};
use crate::trial::SceneTrial;
use crate::{output, progress};

/// More threads than this only cost their setting up.
const MOST_THREADS: NonZeroUsize = NonZeroUsize::MIN.saturating_add(255);

pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let mut study = config::load(&args.config).map_err(Failure::usage)?;
    if let Some(seed) = args.seed {
        study.override_seed(seed).map_err(Failure::usage)?;
    }
    if let Some(trials) = args.trials {
        study
            .override_trials(trials.get())
            .map_err(Failure::usage)?;
    }
    let numbers: Vec<usize> = (0..study.cells.len())
        .step_by(args.every_nth_cell.get())
        .collect();
    let scenes = scenes(&study, &numbers)?;
    refuse_maps_of_rolls(&study, &scenes)?;
    let cells: Vec<Cell<'_>> = numbers
        .iter()
        .zip(&scenes)
        .map(|(&number, trial)| Cell {
            trials: trial.0.trials(study.cells[number].config.trials),
            trial,
        })
        .collect();

    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out").join(&study.config.name));
    output::make_directory(&out)?;
    let bar = progress::bar(cells.iter().map(|cell| cell.trials).sum());
    let options = RunOptions {
        threads: args.threads.map(|threads| threads.min(MOST_THREADS)),
    };
    let statistics = palpate_sweep::run(&cells, &options, &|finished| bar.inc(finished))
        .map_err(Failure::work)?;
    bar.finish_and_clear();

    let ran: Vec<Ran<'_>> = numbers
        .iter()
        .zip(&scenes)
        .zip(&statistics)
        .map(|((&cell, scene), statistics)| Ran {
            cell,
            scene: &scene.0,
            statistics,
        })
        .collect();
    let mut files = vec![
        (
            "cells.csv",
            tables::cells(&study, &ran).map_err(Failure::work)?,
        ),
        (
            "failures.csv",
            tables::failures(&ran).map_err(Failure::work)?,
        ),
        ("run.toml", resolved(&study)),
    ];
    if study.config.outputs.contains(&Output::Trace) {
        let (contacts, readings) = trace_tables(&study, &scenes[0].0, None)?;
        files.push(("trace.csv", contacts.to_csv()));
        files.push(("readings.csv", readings.to_csv()));
    }
    if study.config.outputs.contains(&Output::Map) {
        files.push(("map.csv", maps(&study, &ran)));
    }
    output::write_files(&out, &files)?;
    output::print(&summary(&study, &ran, &out))
}

fn scenes(study: &Study, numbers: &[usize]) -> Result<Vec<SceneTrial>, Failure> {
    numbers
        .iter()
        .map(|&cell| study.estimable_scene(cell).map(SceneTrial))
        .collect::<Result<_, _>>()
        .map_err(Failure::usage)
}

fn refuse_maps_of_rolls(study: &Study, scenes: &[SceneTrial]) -> Result<(), Failure> {
    let is_roll = |scene: &SceneTrial| matches!(scene.0, Scene::Roll(_));
    if study.config.outputs.contains(&Output::Map) && scenes.iter().any(is_roll) {
        let message = "a roll has no map; \"cells\" and \"trace\" are possible";
        return Err(Failure::usage(study.error_at(0, "outputs", message)));
    }
    Ok(())
}

/// The maps of the first trial of every cell that was run. A trial that fails has none, which is
/// said.
fn maps(study: &Study, ran: &[Ran<'_>]) -> String {
    let mut table = MapTable::of_cells(study.config.length_unit);
    let mut missing = Vec::new();
    for Ran { cell, scene, .. } in ran {
        if let Scene::Glide(glide) = scene
            && let Err(error) = glide.map(*cell, 0, &mut table)
        {
            missing.push(format!("{cell} ({})", error.name()));
        }
    }
    if !missing.is_empty() {
        let cells = missing.join(", ");
        eprintln!("warning: map.csv lacks cells whose trial 0 failed: {cells}");
    }
    table.into_csv()
}

/// The config with all defaults and overrides, as it was run.
fn resolved(study: &Study) -> String {
    config::to_toml(&StudyConfig {
        crate_version: Some(env!("CARGO_PKG_VERSION").to_owned()),
        ..study.config.clone()
    })
}

/// Truth and readings of one pass.
pub(crate) fn trace_tables(
    study: &Study,
    scene: &Scene,
    trial: Option<u64>,
) -> Result<(Table, Table), Failure> {
    let unit = study.config.length_unit;
    Ok(match scene {
        Scene::Roll(roll) => {
            let trace = roll.trace(trial, unit).map_err(Failure::work)?;
            (trace.contacts, trace.readings)
        }
        Scene::Glide(glide) => {
            let trace = glide.trace(trial, unit);
            (trace.contacts, trace.readings)
        }
    })
}

fn summary(study: &Study, ran: &[Ran<'_>], out: &std::path::Path) -> String {
    let trials: u64 = ran.iter().map(|ran| ran.statistics.trials).sum();
    let mut kinds = std::collections::BTreeMap::new();
    for failure in ran.iter().flat_map(|ran| &ran.statistics.failures) {
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
