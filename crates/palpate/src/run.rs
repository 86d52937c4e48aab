//! `palpate run`.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Instant;

use palpate_scene::Scene;
use palpate_scene::config::{self, Output, Study, StudyConfig};
use palpate_scene::glide::MapTable;
use palpate_scene::press::ProfileTable;
use palpate_sweep::{Cell, RunOptions};

use crate::allowance;
use crate::cli::RunArgs;
use crate::failure::Failure;
use crate::tables::{self, Ran};
use crate::trial::SceneTrial;
use crate::{foreign, output, progress};

/// What is written.
const CELLS: &str = "cells.csv";
const FAILURES: &str = "failures.csv";
const TRACE: &str = "trace.csv";
const READINGS: &str = "readings.csv";
const MARKERS: &str = "markers.csv";
const FRAMES: [&str; 2] = ["rest.png", "pressed.png"];
const MAP: &str = "map.csv";
/// More threads than this only cost their setting up.
const MOST_THREADS: NonZeroUsize = NonZeroUsize::MIN.saturating_add(255);

pub(crate) fn run(args: &RunArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let mut study = config::load(&args.config).map_err(Failure::usage)?;
    if let Some(seed) = args.seed {
        study.override_seed(seed).map_err(Failure::usage)?;
    }
    if let Some(trials) = args.trials {
        study
            .override_trials(trials.get())
            .map_err(Failure::usage)?;
    }
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("out").join(&study.config.name));
    foreign::refuse(&out, &tables_of(&study))?;
    let numbers: Vec<usize> = (0..study.cells.len())
        .step_by(args.every_nth_cell.get())
        .collect();
    let allowed = allowance::choose(&study, &numbers, args, start)?;
    let said = allowed.map(|allowed| {
        study = allowed.study;
        (allowed.lines, allowed.warnings)
    });
    let scenes = scenes(&study, &numbers)?;
    refuse_maps(&study, &scenes)?;
    let cells: Vec<Cell<'_>> = numbers
        .iter()
        .zip(&scenes)
        .map(|(&number, trial)| Cell {
            trials: trial.0.trials(study.cells[number].config.trials),
            trial,
        })
        .collect();

    output::make_directory(&out)?;
    // Before the work, which would be lost where there is no pass to follow.
    let traced = study.config.outputs.contains(&Output::Trace);
    let traced = traced
        .then(|| trace_files(&study, &scenes[0].0, None))
        .transpose()?;
    let config = resolved(&study);
    output::begin(&out, &config)?;
    if let Some((lines, warnings)) = said {
        for warning in warnings {
            eprintln!("warning: {warning}");
        }
        output::print(&lines.join("\n"))?;
    }
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
    let mut files: Vec<(&str, Vec<u8>)> = vec![
        (
            CELLS,
            tables::cells(&study, &ran).map_err(Failure::work)?.into(),
        ),
        (
            FAILURES,
            tables::failures(&ran).map_err(Failure::work)?.into(),
        ),
        (output::CONFIG, config.into()),
    ];
    files.extend(traced.into_iter().flat_map(|traced| traced.files));
    if study.config.outputs.contains(&Output::Map) {
        files.push((MAP, maps(&study, &ran).into()));
    }
    let written = output::write_files(&out, &files);
    let ended = output::end(&out);
    written?;
    ended?;
    output::print(&summary(&study, &ran, &out))
}

/// All that a run of the study may write beside its config.
fn tables_of(study: &Study) -> Vec<&'static str> {
    let mut names = vec![CELLS, FAILURES];
    if study.config.outputs.contains(&Output::Trace) {
        names.extend([TRACE, READINGS, MARKERS]);
        names.extend(FRAMES);
    }
    if study.config.outputs.contains(&Output::Map) {
        names.push(MAP);
    }
    names
}

fn scenes(study: &Study, numbers: &[usize]) -> Result<Vec<SceneTrial>, Failure> {
    numbers
        .iter()
        .map(|&cell| study.estimable_scene(cell).map(SceneTrial))
        .collect::<Result<_, _>>()
        .map_err(Failure::usage)
}

fn refuse_maps(study: &Study, scenes: &[SceneTrial]) -> Result<(), Failure> {
    if !study.config.outputs.contains(&Output::Map) {
        return Ok(());
    }
    let is_press = |scene: &SceneTrial| matches!(scene.0, Scene::Press(_));
    let message = if scenes.iter().any(|scene| matches!(scene.0, Scene::Roll(_))) {
        "a roll has no map; \"cells\" and \"trace\" are possible"
    } else if scenes
        .iter()
        .any(|scene| matches!(scene.0, Scene::Fingertip(_)))
    {
        "a fingertip that touches nothing has no map; \"cells\" is possible"
    } else if scenes.iter().any(is_press) && !scenes.iter().all(is_press) {
        "maps of glides and presses do not share a table; \"cells\" and \"trace\" are possible"
    } else {
        return Ok(());
    };
    Err(Failure::usage(study.error_at(0, "outputs", message)))
}

/// The maps, or profiles, of the first trial of every cell that was run. A trial that fails has
/// none, which is said.
fn maps(study: &Study, ran: &[Ran<'_>]) -> String {
    let unit = study.config.length_unit;
    let mut maps = MapTable::of_cells(unit);
    let mut profiles = ProfileTable::of_cells(unit);
    let mut is_press = false;
    let mut missing = Vec::new();
    for Ran { cell, scene, .. } in ran {
        let failed = match scene {
            Scene::Roll(_) | Scene::Fingertip(_) => None,
            Scene::Glide(glide) => glide.map(*cell, 0, &mut maps).err().map(|e| e.name()),
            Scene::Press(press) => {
                is_press = true;
                press
                    .profile(*cell, 0, &mut profiles)
                    .err()
                    .map(|e| e.name())
            }
        };
        missing.extend(failed.map(|name| format!("{cell} ({name})")));
    }
    if !missing.is_empty() {
        let what = if is_press {
            "estimates of cells"
        } else {
            "cells"
        };
        let cells = missing.join(", ");
        eprintln!("warning: map.csv lacks {what} whose trial 0 failed: {cells}");
    }
    if is_press {
        profiles.into_csv()
    } else {
        maps.into_csv()
    }
}

/// The config with all defaults and overrides, as it was run.
fn resolved(study: &Study) -> String {
    config::to_toml(&StudyConfig {
        crate_version: Some(env!("CARGO_PKG_VERSION").to_owned()),
        ..study.config.clone()
    })
}

/// One pass, as files.
pub(crate) struct Traced {
    /// Their names and contents.
    pub(crate) files: Vec<(&'static str, Vec<u8>)>,
    /// How many contacts the truth has, or markers.
    pub(crate) contacts: usize,
    /// How many rows the readings have.
    pub(crate) readings: usize,
    /// Whether a camera saw it.
    pub(crate) is_seen: bool,
}

/// Truth and readings of one pass, and what a camera saw of it.
pub(crate) fn trace_files(
    study: &Study,
    scene: &Scene,
    trial: Option<u64>,
) -> Result<Traced, Failure> {
    let unit = study.config.length_unit;
    let (contacts, readings, seen) = match scene {
        Scene::Roll(roll) => {
            let trace = roll.trace(trial, unit).map_err(Failure::work)?;
            (trace.contacts, trace.readings, None)
        }
        Scene::Glide(glide) => {
            let trace = glide.trace(trial, unit);
            (trace.contacts, trace.readings, None)
        }
        Scene::Press(press) => {
            let trace = press.trace(trial, unit).map_err(Failure::work)?;
            (trace.contacts, trace.readings, trace.seen)
        }
        Scene::Fingertip(_) => {
            let message = "a fingertip touches nothing: there is no pass to follow";
            return Err(Failure::usage(study.error_at(0, "scene.kind", message)));
        }
    };
    let mut files = vec![
        (TRACE, contacts.to_csv().into_bytes()),
        (READINGS, readings.to_csv().into_bytes()),
    ];
    let is_seen = seen.is_some();
    if let Some(seen) = seen {
        files.push((MARKERS, seen.markers.to_csv().into_bytes()));
        for (name, frame) in FRAMES.into_iter().zip(seen.frames.iter().flatten()) {
            files.push((name, output::png(frame)?));
        }
    }
    Ok(Traced {
        files,
        contacts: contacts.rows.len(),
        readings: readings.rows.len(),
        is_seen,
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
