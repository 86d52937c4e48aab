//! The trials of a study's cells, and the tables that they give.

mod finished;
mod ready;
mod warnings;

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use palpate_scene::{Arch, Scene, Scenes, SharedModels};
use palpate_study::MapTable;
use palpate_study::Table;
use palpate_study::config::{Cell, ConfigError, Output, Study};
use palpate_sweep::{
    CellStatistics, NoThreads, RunOptions, Runner, StoppingRule, Sweep, SweepError, SweepOutput,
    Task, TrialObservations,
};
use thiserror::Error;

use crate::columns::ColumnType;
use crate::facts::Facts;
use crate::map::{CellMap, Map};
use crate::means;
use crate::share::{Shard, Share};
use crate::tables::{self, Row};
use crate::trial::SceneTrial;

pub use finished::{CellRows, Finished};
pub use warnings::Warnings;

use ready::Ready;

/// Most cells that are all set up before the first trial is run; of more, those of the study's sample, and the others when
/// they are run.
const MOST_CHECKED: u64 = 10_000;
/// Scenes that are kept from their check until they are run. Those of further cells are set up once more, which bounds
/// the memory of a study of many cells; a scene with a camera takes a second to set up.
const KEPT: usize = 64;

/// Cells of a study that have been checked and are ready to run.
///
/// ```
/// use std::sync::atomic::AtomicBool;
/// use palpate::{RunOptions, Runner, Simulation};
///
/// let text = r#"
/// name = "balls"
/// trials = 100
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// noise = { angular_velocity = { kind = "uniform", fraction = 0.05 } }
/// [[sweep]]
/// path = "scene.object.radius"
/// values = [30.0, 60.0, 90.0]
/// "#;
/// let study = palpate::parse("balls.toml", text)?;
/// let runner = Runner::new(&RunOptions::default())?;
/// // The last cell alone.
/// let simulation = Simulation::new(&study, [2], &runner)?;
/// assert_eq!(simulation.trials(), 100);
/// let ran = simulation.run(&AtomicBool::new(false), &|_finished| ())?;
/// assert_eq!((ran.statistics.len(), ran.cells.rows[0][0].as_str()), (1, "2"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Simulation<'a> {
    study: &'a Study,
    runner: &'a Runner,
    arch: Arch,
    share: Share,
    states_bounds: bool,
    /// Empty table for maps of the cells' scenes; `None` where the config asks for no maps.
    maps: Option<MapTable>,
    warnings: Warnings,
    /// Whether single trials are told.
    tells_trials: bool,
    /// Scenes that have been checked and not yet been run, by the numbers of their cells.
    kept: Mutex<BTreeMap<usize, (Cell, Scene)>>,
    /// SharedModels that scenes share.
    parts: SharedModels,
}

impl<'a> Simulation<'a> {
    /// Sets up the cells with these numbers one by one, each on any of the runner's threads, and keeps few of them.
    ///
    /// # Errors
    /// [`ConfigError`] at the field that makes no scene, that leaves nothing to estimate from, or that asks for a map of
    /// what has none, of the first cell that has such a field; for a number that no cell has.
    pub fn new(
        study: &'a Study,
        numbers: impl IntoIterator<Item = usize>,
        runner: &'a Runner,
    ) -> Result<Self, ConfigError> {
        let cells = numbers.into_iter().collect();
        Self::of_shard(study, cells, Shard::default(), runner)?.checked()
    }

    /// Simulation of a shard of the cells with these numbers, none of which has been checked.
    ///
    /// # Errors
    /// [`ConfigError`] of the first cell, whose scene is set up where maps are asked for.
    pub fn of_shard(
        study: &'a Study,
        numbers: Vec<usize>,
        shard: Shard,
        runner: &'a Runner,
    ) -> Result<Self, ConfigError> {
        let has_maps = study.config.outputs.contains(&Output::Map);
        let parts = SharedModels::default();
        let mut kept = BTreeMap::new();
        let mut maps = None;
        if let (true, Some(&first)) = (has_maps, numbers.first()) {
            let cell = study.cell(first)?;
            let scene = study.estimable_scene_of(first, &cell, &parts)?;
            maps = Some(map_table(study, &scene)?);
            kept.insert(first, (cell, scene));
        }
        Ok(Self {
            study,
            runner,
            arch: Arch::new(),
            share: Share::new(numbers, shard),
            states_bounds: tables::states_bounds(study),
            maps,
            warnings: Warnings::default(),
            tells_trials: false,
            kept: Mutex::new(kept),
            parts,
        })
    }

    /// The simulation after its cells have been set up, and seen to be sound: of more than 10,000 those of the study's
    /// [sample](Study::sample).
    ///
    /// # Errors
    /// [`ConfigError`], as [`Simulation::new`] has.
    pub fn checked(self) -> Result<Self, ConfigError> {
        let warnings = Mutex::new(Warnings::default());
        let count = self.share.tasks() as usize;
        self.runner.check(count, |place| {
            let number = self.share.cell(place as u64);
            if self.is_sampled() && self.study.sample().binary_search(&number).is_err() {
                return Ok(());
            }
            let cell = self.study.cell(number)?;
            let scene = self.scene(number, &cell)?;
            if let Some(maps) = &self.maps
                && map_table(self.study, &scene)? != *maps
            {
                return Err(self.study.error_at(0, "outputs", UNLIKE_MAPS));
            }
            let lines = warnings_of(&scene);
            if !lines.is_empty() {
                lock(&warnings).add(number, lines);
            }
            if place < KEPT {
                lock(&self.kept).insert(number, (cell, scene));
            }
            Ok::<(), ConfigError>(())
        })?;
        let warnings = warnings.into_inner();
        Ok(Self {
            warnings: warnings.unwrap_or_else(PoisonError::into_inner),
            ..self
        })
    }

    /// The simulation with trials side by side computed by other instructions than the widest that the processor has; no
    /// number depends on them.
    #[must_use]
    pub fn with_arch(self, arch: Arch) -> Self {
        Self { arch, ..self }
    }

    /// The simulation with rows of every trial, which [`Simulation::stream`] hands over before those of its cell, and
    /// [`Simulation::run`] as a table.
    #[must_use]
    pub fn with_trials(self) -> Self {
        Self {
            tells_trials: true,
            ..self
        }
    }

    /// Number of trials of all cells together, at most the largest number of 64 bits; where nothing in a cell is random,
    /// fewer are run.
    pub fn trials(&self) -> u64 {
        self.share.trials_before(self.study, self.share.tasks())
    }

    /// Number of trials of the first tasks, as [`Simulation::trials`] counts them.
    pub fn trials_before(&self, tasks: u64) -> u64 {
        self.share.trials_before(self.study, tasks)
    }

    /// Number of tasks: the cells of this shard.
    pub fn tasks(&self) -> u64 {
        self.share.tasks()
    }

    /// Whether there are so many cells that only some are set up before the first trial. Then each cell that is run tells
    /// its warnings itself.
    pub fn is_sampled(&self) -> bool {
        self.share.tasks() > MOST_CHECKED
    }

    /// Number of tasks of all shards together.
    pub fn all_tasks(&self) -> u64 {
        self.share.cells.len() as u64
    }

    /// Cell of the task with this number.
    pub fn cell_of(&self, task: u64) -> usize {
        self.share.cell(task)
    }

    /// Warnings of the cells that have been set up, in which the theory or the estimator does not hold.
    pub fn told(&self) -> &Warnings {
        &self.warnings
    }

    /// Lines that warn of cells in which the theory or the estimator does not hold, as `check` has them; each once, with
    /// the cells that it is of.
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.lines(self.share.cells.len())
    }

    /// Columns of `cells.csv`, `failures.csv`, where the config asks for maps `map.csv`, and where trials are told the table
    /// of these.
    pub fn columns(&self) -> [Option<Vec<ColumnType>>; 4] {
        let unit = self.study.config.length_unit;
        let beside = |names: &[&str]| {
            let columns = names.iter().map(|name| ColumnType::beside_unit(name));
            columns.collect::<Vec<_>>()
        };
        let named = |maps: &MapTable| {
            let names = maps.table.header.iter();
            names.map(|name| ColumnType::named(name, unit)).collect()
        };
        [
            Some(tables::columns(self.study, self.states_bounds)),
            Some(beside(&tables::FAILURES)),
            self.maps.as_ref().map(named),
            self.tells_trials.then(|| beside(&tables::TRIALS)),
        ]
    }

    /// Name of what may be missing in maps: "cells" or "estimates of cells".
    pub fn lacks(&self) -> &'static str {
        self.maps.as_ref().map_or("cells", |maps| maps.lacks)
    }

    /// Runs the tasks from `first` on, until another thread sets `cancelled` or `take` returns `Break`. Any thread
    /// calls `make`. `take` receives the results in task order. With per-trial output, each result follows the rows
    /// of its trials. Any thread calls `progress` with the number of trials that it has done since its last call.
    ///
    /// # Errors
    /// [`SweepError::Cancelled`], also if `take` returns `Break`; [`SweepError::SetUp`] if a cell cannot be set up.
    ///
    /// # Panics
    /// If `progress`, `make` or `take` panics.
    pub fn stream<R: Send>(
        &self,
        first: u64,
        cancelled: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
        make: impl Fn(Finished) -> R + Sync,
        take: &mut (dyn FnMut(u64, SweepOutput<R>) -> ControlFlow<()> + Send),
    ) -> Result<(), SweepError<ConfigError>> {
        let tasks = Tasks {
            simulation: self,
            first,
            make,
        };
        let take = &mut |number: u64, taken: SweepOutput<R>| take(first + number, taken);
        self.runner.stream(&tasks, cancelled, progress, take)
    }

    /// Runs all trials, until another thread sets `cancelled`: then no trial begins. `progress` is told by any thread how
    /// many it has done since it last told.
    ///
    /// # Errors
    /// [`SweepError`], before any trial is run; [`SweepError::Cancelled`].
    ///
    /// # Panics
    /// Where `progress` does.
    pub fn run(
        &self,
        cancelled: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Ran, SweepError<ConfigError>> {
        let mut cells: Vec<Finished> = Vec::new();
        let mut trials = tables::TRIALS.join(",") + "\n";
        let take = &mut |_: u64, taken: SweepOutput<Finished>| {
            match taken {
                SweepOutput::TrialRows(rows) => trials.push_str(&rows),
                SweepOutput::Result(finished) => cells.push(finished),
            }
            ControlFlow::Continue(())
        };
        self.stream(0, cancelled, progress, |finished| finished, take)?;
        let rows: Vec<Row<'_>> = cells.iter().map(Finished::row).collect();
        Ok(Ran {
            cells: tables::cells(self.study, &rows, self.states_bounds),
            failures: tables::failures(&rows),
            trials: self.tells_trials.then_some(trials),
            map: self.maps.is_some().then(|| {
                let maps = cells.iter_mut().filter_map(|cell| cell.map.take());
                Map::of_cells(maps)
            }),
            statistics: cells.into_iter().map(|cell| cell.statistics).collect(),
        })
    }

    fn scene(&self, number: usize, cell: &Cell) -> Result<Scene, ConfigError> {
        self.study.estimable_scene_of(number, cell, &self.parts)
    }

    /// Experiment of a cell, with what its tables state of it.
    fn set_up(&self, number: usize) -> Result<Ready, ConfigError> {
        let kept = lock(&self.kept).remove(&number);
        let (cell, scene) = match kept {
            Some(kept) => kept,
            None => {
                let cell = self.study.cell(number)?;
                let scene = self.scene(number, &cell)?;
                (cell, scene)
            }
        };
        let map = self.maps.clone();
        Ok(Ready {
            cell: number,
            warnings: match self.is_sampled() {
                true => warnings_of(&scene),
                false => Vec::new(),
            },
            map: map.map(|table| CellMap::of(&scene, number, table)),
            facts: Arc::new(Facts::of(&scene, cell)),
            trial: SceneTrial {
                scene,
                arch: self.arch,
            },
        })
    }
}

const UNLIKE_MAPS: &str =
    "maps of glides and presses do not share a table; \"cells\" and \"trace\" are possible";

/// Empty table for maps of a scene.
fn map_table(study: &Study, scene: &Scene) -> Result<MapTable, ConfigError> {
    let table = scene.map_table(study.config.length_unit);
    table.map_err(|message| study.error_at(0, "outputs", message))
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Tasks of a simulation, from the first that is to be run.
struct Tasks<'s, 'a, F> {
    simulation: &'s Simulation<'a>,
    first: u64,
    make: F,
}

impl<R: Send, F: Fn(Finished) -> R + Sync> Sweep for Tasks<'_, '_, F> {
    type Trial = Ready;
    type Result = R;
    type Error = ConfigError;

    fn tasks(&self) -> u64 {
        self.simulation.share.tasks().saturating_sub(self.first)
    }

    fn task(&self, number: u64) -> Task {
        let simulation = self.simulation;
        simulation.share.task(simulation.study, self.first + number)
    }

    fn set_up(&self, cell: usize) -> Result<Ready, ConfigError> {
        self.simulation.set_up(cell)
    }

    fn stopping_rule(&self, trial: &Ready) -> Option<StoppingRule> {
        trial.stop(self.simulation.study)
    }

    fn has_trial_rows(&self) -> bool {
        self.simulation.tells_trials
    }

    fn add_trial_row(
        &self,
        trial: &Ready,
        number: u64,
        observed: Result<&TrialObservations<'_>, &'static str>,
        text: &mut String,
    ) {
        let unit = self.simulation.study.config.length_unit;
        tables::push_trial(
            text,
            (trial.cell, number),
            trial.facts.quantities,
            unit,
            observed,
        );
    }

    fn finish(&self, cell: usize, trial: &Ready, mut statistics: CellStatistics) -> R {
        means::withhold(trial.facts.quantities, &mut statistics.quantities);
        (self.make)(Finished {
            cell,
            facts: Arc::clone(&trial.facts),
            warnings: trial.warnings.clone(),
            map: trial.map.clone(),
            statistics,
        })
    }
}

impl Simulation<'_> {
    /// Table rows of a finished cell.
    pub fn rows(&self, finished: &Finished) -> CellRows {
        let rows = [finished.row()];
        let map = finished.map.as_ref();
        CellRows {
            cells: tables::cells_csv(self.study, &rows[0], self.states_bounds),
            failures: tables::failures(&rows).rows_to_csv(),
            map: map.map_or_else(String::new, CellMap::rows),
            map_failed: map.and_then(|map| map.failed),
            trials: finished.statistics.trials,
            kinds: finished.statistics.failures.clone(),
            warnings: finished.warnings.clone(),
        }
    }
}

/// Warnings of a scene, one line each.
fn warnings_of(scene: &Scene) -> Vec<String> {
    let needs = scene.needs().into_iter();
    let warnings = needs.filter(|need| need.warning().is_some());
    warnings.map(|need| need.to_string()).collect()
}

/// Results of the trials of a [`Simulation`].
#[derive(Clone, Debug, PartialEq)]
pub struct Ran {
    /// Statistics of each cell, in the order of their numbers.
    pub statistics: Vec<CellStatistics>,
    /// Table `cells.csv`: one row per cell and quantity.
    pub cells: Table,
    /// Table `failures.csv`: one row per cell and kind of failure.
    pub failures: Table,
    /// Table `map.csv`, of the first trial of every cell; `None` where the config asks for none.
    pub map: Option<Map>,
    /// Table of all trials as CSV text, one row per observation or failure; `None` unless it was
    /// [asked for](Simulation::with_trials).
    pub trials: Option<String>,
}

/// Study that cannot be run.
#[derive(Debug, Error)]
pub enum RunError {
    /// Lack of threads.
    #[error(transparent)]
    NoThreads(#[from] NoThreads),
    /// Field of a cell's config that makes no scene.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Trials that cannot be run.
    #[error(transparent)]
    Sweep(#[from] SweepError<ConfigError>),
}

/// Runs all cells of a study on all processors.
///
/// ```
/// let text = r#"
/// name = "a-ball"
/// length_unit = "mm"
/// trials = 100
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
/// noise = { angular_velocity = { kind = "uniform", fraction = 0.05 } }
/// "#;
/// let study = palpate::parse("a-ball.toml", text)?;
/// let ran = palpate::run(&study)?;
/// // Statistics of the normal curvature along u, 1/mm.
/// let curvature = ran.statistics[0].quantities[0];
/// assert_eq!(curvature.truth, Some(1.0 / 30.0));
/// assert!(curvature.relative_rms_error.ok_or("of a ball")? < 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RunError`], before any trial is run.
pub fn run(study: &Study) -> Result<Ran, RunError> {
    let runner = Runner::new(&RunOptions::default())?;
    let simulation = Simulation::new(study, 0..study.cell_count(), &runner)?;
    Ok(simulation.run(&AtomicBool::new(false), &|_| ())?)
}
