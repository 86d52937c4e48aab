//! `palpate check`.

use palpate_scene::Scenes;
use std::fmt::Write;
use std::time::{Duration, Instant};

use palpate_study::config::{self, PressSensorConfig, SceneConfig, Study};
use palpate_sweep::Cell;

use crate::cli::CheckArgs;
use crate::duration::roughly;
use crate::failure::Failure;
use crate::ladder;
use crate::output;
use crate::pace::{self, Pace};
use crate::rungs;
use palpate::SceneTrial;

/// Times after which no more scenes are set up as they are run, no more trials are timed, and no more rungs of ladders
/// are measured.
const SETTING_UP: Duration = Duration::from_millis(800);
const TIMING: Duration = Duration::from_millis(300);
const LADDERS: Duration = Duration::from_millis(600);

pub(crate) fn check(args: &CheckArgs) -> Result<(), Failure> {
    let study = config::load(&args.config).map_err(Failure::usage)?;
    let start = Instant::now();
    let bare = bare(&study);
    let scenes = scenes(&study, &bare)?;
    let share = study.cells.len() as f64 / scenes.len() as f64;
    let planning = start.elapsed().as_secs_f64() * share;
    let cells: Vec<Cell<'_>> = scenes
        .iter()
        .map(|(cell, trial)| Cell {
            trials: trial.scene.trials(study.cells[*cell].config.trials),
            trial,
        })
        .collect();
    let trials: Vec<u64> = cells.iter().map(|cell| cell.trials).collect();
    let known = trials.iter().sum::<u64>();
    let unknown = (0..study.cells.len())
        .filter(|cell| scenes.iter().all(|(known, _)| known != cell))
        .map(|cell| study.cells[cell].config.trials)
        .sum::<u64>();

    let mut text = String::new();
    let noiseless = trials.iter().filter(|&&trials| trials == 1).count();
    let (mut not_set_up, mut at_most) = (String::new(), "");
    if scenes.len() < study.cells.len() {
        not_set_up = format!("; {} were set up, to be quick", scenes.len());
        at_most = "at most ";
    }
    let _ = writeln!(text, "study   {}", study.config.name);
    let _ = writeln!(
        text,
        "cells   {}, of which {noiseless} run a single trial{not_set_up}",
        study.cells.len()
    );
    let _ = writeln!(text, "trials  {at_most}{}", known + unknown);
    let _ = writeln!(text, "models");
    models(&mut text, &study, &bare, &scenes)?;
    let threads = pace::threads(None);
    let pace = Pace::of(&cells, threads, TIMING).map_err(Failure::work)?;
    let of_all = (known + unknown) as f64 / known as f64;
    let seconds = planning + of_all * pace.run_seconds(&trials, threads);
    let _ = write!(
        text,
        "time    about {} on {threads} threads, planning included",
        roughly(seconds)
    );
    output::print(&text)
}

/// Study whose presses are read without a camera, so that scenes are quick to set up.
fn bare(study: &Study) -> Study {
    let mut bare = study.clone();
    for cell in &mut bare.cells {
        if matches!(cell.config.scene, SceneConfig::Press(_)) {
            cell.config.scene = rungs::bare(&cell.config.scene);
        }
    }
    bare
}

/// Scenes of the cells, in order, as many as there is time for; once the time is up, cells are set up without a camera.
fn scenes(study: &Study, bare: &Study) -> Result<Vec<(usize, SceneTrial)>, Failure> {
    let start = Instant::now();
    let mut scenes = Vec::new();
    for cell in pace::spread(study.cells.len()) {
        let is_press = matches!(study.cells[cell].config.scene, SceneConfig::Press(_));
        if is_press && !scenes.is_empty() && start.elapsed() >= SETTING_UP {
            bare.scene(cell).map_err(Failure::usage)?;
        } else {
            let scene = study.estimable_scene(cell).map_err(Failure::usage)?;
            scenes.push((cell, SceneTrial::new(scene)));
        }
    }
    scenes.sort_by_key(|(cell, _)| *cell);
    Ok(scenes)
}

/// Appends to `text` the models that each group of cells needs, with the rungs of their ladder.
fn models(
    text: &mut String,
    study: &Study,
    bare: &Study,
    scenes: &[(usize, SceneTrial)],
) -> Result<(), Failure> {
    let deadline = Instant::now() + LADDERS;
    let mut told: Vec<(&SceneConfig, bool, usize)> = Vec::new();
    for Group {
        needs,
        place,
        cells,
    } in groups(scenes)
    {
        let (cell, trial) = &scenes[place];
        let _ = writeln!(text, "  {cells} of {} cells", study.cells.len());
        for need in needs {
            let _ = writeln!(text, "    {need}");
        }
        let scene = &bare.cells[*cell].config.scene;
        // The camera sees markers at other depths than those at which displacements are read without one.
        let by_camera = match &study.cells[*cell].config.scene {
            SceneConfig::Press(press) => !matches!(press.sensor, PressSensorConfig::Direct { .. }),
            _ => false,
        };
        let like = |known: &&(&SceneConfig, bool, usize)| (known.0, known.1) == (scene, by_camera);
        if let Some((.., other)) = told.iter().find(like) {
            let _ = writeln!(text, "    rungs of the model: as in cell {other}");
            continue;
        }
        let in_time = Instant::now() < deadline;
        let ladder = in_time
            .then(|| study.ladder_of(*cell, &trial.scene))
            .transpose();
        let ladder = ladder.map_err(Failure::usage)?.flatten();
        let taken = ladder.as_ref().map(|ladder| &ladder.taken().model);
        let needless = ladder::not_needed(trial, &study.cells[*cell].config.scene, taken);
        if let Some(needless) = needless {
            let _ = writeln!(text, "    {needless}");
        }
        match &ladder {
            Some(ladder) => {
                let error_of = ladder::error_of(ladder);
                let _ = writeln!(
                    text,
                    "    rungs of the model, in cell {cell}; errors: {error_of}"
                );
                for line in ladder::lines(bare, *cell, ladder, deadline) {
                    let _ = writeln!(text, "      {line}");
                }
                told.push((scene, by_camera, *cell));
            }
            None if in_time => {}
            None => {
                let _ = writeln!(text, "    rungs of the model: not measured, to be quick");
            }
        }
    }
    Ok(())
}

/// Cells that need the same models.
struct Group {
    needs: Vec<String>,
    /// Index in `scenes` of the first cell of the group.
    place: usize,
    cells: usize,
}

fn groups(scenes: &[(usize, SceneTrial)]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    let all = scenes.iter().map(|(_, trial)| trial.scene.needs());
    for (place, needs) in all.enumerate() {
        match groups.iter_mut().find(|known| known.needs == needs) {
            Some(known) => known.cells += 1,
            None => groups.push(Group {
                needs,
                place,
                cells: 1,
            }),
        }
    }
    groups
}
