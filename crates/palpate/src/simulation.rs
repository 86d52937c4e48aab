//! Simulates a study: runs the trials of its cells, and makes the tables of results.

mod cell_setup;

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use palpate_scene::{Arch, Need, Scene, SceneTrial, Scenes, SharedModels, map_table_of};
use palpate_study::config::{Cell, ConfigError, Output, Study};
use palpate_study::{Column, FieldError, Table, Warning};
use palpate_sweep::{
    CellStatistics, Failure, RunOptions, Runner, StoppingRule, Sweep, SweepError, SweepOutput,
    Task, TrialObservations, drop_undefined_moments,
};

use crate::run_files::{self, Row};
use crate::shard::{Shard, ShardTasks};
use crate::warnings::Warnings;
use cell_setup::CellSetup;

pub(crate) use cell_setup::CellTruth;

/// Largest number of cells for which every cell is set up, and so checked, before the first trial. In a larger study,
/// only a sample of cells is checked.
const MAX_CHECKED: u64 = 10_000;
/// Number of scenes that stay in memory after the check of the cells until their trials run. To save memory, all other
/// scenes are set up twice: for the check and for their trials.
const MAX_CACHED: usize = 64;

/// Simulation of some or all cells of a study.
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
/// assert_eq!(simulation.trials_before(1), 100);
/// let ran = simulation.run(&AtomicBool::new(false), &|_trials| ())?;
/// assert_eq!((ran.statistics.len(), ran.cells.rows[0][0].as_str()), (1, "2"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Simulation<'a> {
    study: &'a Study,
    runner: &'a Runner,
    /// The vector instructions that the simulation uses. The results do not depend on this choice.
    pub arch: Arch,
    tasks: ShardTasks,
    states_bounds: bool,
    /// Empty table for the curvature maps of the cells, with its columns; `None` if the config requests no maps.
    maps: Option<Table>,
    /// Warnings from the check of the cells before the run, for example that the contact model or the estimator is not
    /// valid in a cell.
    pub warnings: Warnings,
    /// Whether the simulation also outputs the rows of the table of trials, with one row for each estimate of each
    /// trial. [`Simulation::stream`] outputs the rows of a cell's trials before the result of the cell.
    /// [`Simulation::run`] returns a table of all trials.
    pub has_trials: bool,
    /// Scenes that were set up when the cells were checked, by cell number. The trials use these scenes again.
    cached: Mutex<BTreeMap<usize, (Cell, Scene)>>,
    /// Models that several scenes share, so that each model is set up only once.
    parts: SharedModels,
}

impl<'a> Simulation<'a> {
    /// Simulation of the cells with these numbers. The runner's threads set up the cells to check them.
    ///
    /// # Errors
    /// [`ConfigError`] of the first cell that is invalid: it has an invalid field, its readings allow no estimate, or
    /// the config requests a map that its scene does not have. Also an error if a number in `numbers` is not the number
    /// of a cell.
    pub fn new(
        study: &'a Study,
        numbers: impl IntoIterator<Item = usize>,
        runner: &'a Runner,
    ) -> Result<Self, ConfigError> {
        let cells = numbers.into_iter().collect();
        Self::of_shard(study, cells, Shard::default(), runner)?.checked()
    }

    /// Simulation of one shard. `numbers` contains the cell numbers of all shards together. The cells are not checked.
    ///
    /// # Errors
    /// [`ConfigError`] of the first cell. This cell is set up only if the config requests maps, because its scene
    /// determines the columns of the map.
    pub fn of_shard(
        study: &'a Study,
        numbers: Vec<usize>,
        shard: Shard,
        runner: &'a Runner,
    ) -> Result<Self, ConfigError> {
        let has_maps = study.config.outputs.contains(&Output::Map);
        let parts = SharedModels::default();
        let mut cached = BTreeMap::new();
        let mut maps = None;
        if let (true, Some(&first)) = (has_maps, numbers.first()) {
            let cell = study.cell(first)?;
            let scene = study.estimable_scene_of(first, &cell, &parts)?;
            maps = Some(map_table(study, &cell)?);
            cached.insert(first, (cell, scene));
        }
        Ok(Self {
            study,
            runner,
            arch: Arch::new(),
            tasks: ShardTasks::new(numbers, shard),
            states_bounds: run_files::states_bounds(study),
            maps,
            warnings: Warnings::default(),
            has_trials: false,
            cached: Mutex::new(cached),
            parts,
        })
    }

    /// Checks the cells by setting them up. If there are more than 10,000 cells, only the cells of the study's
    /// [sample](Study::sample) are set up.
    ///
    /// # Errors
    /// The same [`ConfigError`] as [`Simulation::new`].
    pub fn checked(self) -> Result<Self, ConfigError> {
        let warnings = Mutex::new(Warnings::default());
        let count = self.tasks.tasks() as usize;
        self.runner.check(count, |place| {
            let number = self.tasks.cell(place as u64);
            if self.is_sampled() && self.study.sample.binary_search(&number).is_err() {
                return Ok(());
            }
            let cell = self.study.cell(number)?;
            let scene = self.scene(number, &cell)?;
            if let Some(maps) = &self.maps
                && map_table(self.study, &cell)? != *maps
            {
                return Err(self
                    .study
                    .error_at(0, FieldError::at("outputs", UNLIKE_MAPS)));
            }
            let of_cell = warnings_of(&scene);
            lock(&warnings).add(number, &of_cell);
            if place < MAX_CACHED {
                lock(&self.cached).insert(number, (cell, scene));
            }
            Ok::<(), ConfigError>(())
        })?;
        let warnings = warnings.into_inner();
        Ok(Self {
            warnings: warnings.unwrap_or_else(PoisonError::into_inner),
            ..self
        })
    }

    /// Number of trials of the first `tasks` tasks, limited to the largest `u64`. Each cell is one task. The number is
    /// an upper limit, because a cell without noise runs only one trial.
    pub fn trials_before(&self, tasks: u64) -> u64 {
        self.tasks.trials_before(self.study, tasks)
    }

    /// Number of tasks. Each cell of the simulated shard is one task.
    pub fn tasks(&self) -> u64 {
        self.tasks.tasks()
    }

    /// Whether the study has so many cells that only a sample was checked. If so, each cell reports its warnings when
    /// it runs.
    pub fn is_sampled(&self) -> bool {
        self.tasks.tasks() > MAX_CHECKED
    }

    /// Number of the cell that this task runs.
    pub fn cell_of(&self, task: u64) -> usize {
        self.tasks.cell(task)
    }

    /// Columns of `cells.csv`, `failures.csv`, `map.csv` and the table of trials. The columns of `map.csv` are `None`
    /// if the config requests no maps; those of the table of trials are `None` if the rows of trials are not output.
    pub fn columns(&self) -> [Option<Vec<Column>>; 4] {
        let maps = self.maps.as_ref();
        [
            Some(run_files::columns(self.study, self.states_bounds)),
            Some(run_files::failure_columns()),
            maps.map(|maps| maps.columns.clone()),
            self.has_trials.then(run_files::trial_columns),
        ]
    }

    /// Runs all tasks from number `first` on. Stops if another thread sets `cancelled`, or if `take` returns `Break`.
    ///
    /// `make` converts the table rows of a cell; it may be called on any thread. `take` receives the converted rows in
    /// the order of the tasks. If the rows of trials are output, `take` receives them before the result of their cell.
    /// `progress` receives the number of trials that were done since its previous call; it may be called on any
    /// thread.
    ///
    /// # Errors
    /// [`SweepError::Cancelled`] if `cancelled` is set or `take` returns `Break`; [`SweepError::SetUp`] if a cell
    /// cannot be set up.
    ///
    /// # Panics
    /// Panics if `progress`, `make` or `take` panics.
    pub fn stream<R: Send>(
        &self,
        first: u64,
        cancelled: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
        make: impl Fn(CellRows) -> R + Sync,
        take: &mut (dyn FnMut(u64, SweepOutput<R>) -> ControlFlow<()> + Send),
    ) -> Result<(), SweepError<ConfigError>> {
        let make = |results: CellResults| make(self.rows(&results));
        self.stream_results(first, cancelled, progress, make, take)
    }

    fn stream_results<R: Send>(
        &self,
        first: u64,
        cancelled: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
        make: impl Fn(CellResults) -> R + Sync,
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

    /// Runs all trials. Stops if another thread sets `cancelled`. `progress` receives the number of trials that were
    /// done since its previous call; it may be called on any thread.
    ///
    /// # Errors
    /// [`SweepError`] if a cell cannot be set up; [`SweepError::Cancelled`] if `cancelled` is set.
    ///
    /// # Panics
    /// Panics if `progress` panics.
    pub fn run(
        &self,
        cancelled: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Ran, SweepError<ConfigError>> {
        let mut cells: Vec<CellResults> = Vec::new();
        let mut trials = Table::new(run_files::trial_columns()).to_csv();
        let take = &mut |_: u64, taken: SweepOutput<CellResults>| {
            match taken {
                SweepOutput::TrialRows(rows) => trials.push_str(&rows),
                SweepOutput::Result(results) => cells.push(results),
            }
            ControlFlow::Continue(())
        };
        self.stream_results(0, cancelled, progress, |results| results, take)?;
        // In a sampled study, each cell reports its warnings when it runs, so do not count the warnings of the check
        // again.
        let mut warnings = match self.is_sampled() {
            true => Warnings::default(),
            false => self.warnings.clone(),
        };
        cells
            .iter()
            .for_each(|cell| warnings.add(cell.cell, &cell.warnings));
        let rows: Vec<Row<'_>> = cells.iter().map(CellResults::row).collect();
        Ok(Ran {
            cells: run_files::cells(self.study, &rows, self.states_bounds),
            failures: run_files::failures(&rows),
            trials: self.has_trials.then_some(trials),
            map: self.maps.as_ref().map(|maps| {
                let mut table = maps.clone();
                let maps = cells.iter_mut().filter_map(|cell| cell.map.take());
                maps.for_each(|map| table.rows.extend(map.rows));
                table
            }),
            warnings: warnings.grouped(self.tasks.cells.len()),
            statistics: cells.into_iter().map(|cell| cell.statistics).collect(),
        })
    }

    fn scene(&self, number: usize, cell: &Cell) -> Result<Scene, ConfigError> {
        self.study.estimable_scene_of(number, cell, &self.parts)
    }

    /// Returns a cell that is ready for its trials. Uses the scene that was set up when the cell was checked, if this
    /// scene is still in memory.
    fn set_up(&self, number: usize) -> Result<CellSetup, ConfigError> {
        let cached = lock(&self.cached).remove(&number);
        let (cell, scene) = match cached {
            Some(cached) => cached,
            None => {
                let cell = self.study.cell(number)?;
                let scene = self.scene(number, &cell)?;
                (cell, scene)
            }
        };
        let mut warnings = match self.is_sampled() {
            true => warnings_of(&scene),
            false => Vec::new(),
        };
        let map = self.maps.clone().map(|mut map| {
            if let Err(failure) = scene.map(number, 0, &mut map) {
                let text =
                    format!("the map has no estimates, because trial 0 failed as `{failure}`");
                warnings.push(Warning::new("failed-map", text, []));
            }
            map
        });
        Ok(CellSetup {
            cell: number,
            warnings,
            map,
            truth: Arc::new(CellTruth::new(&scene, cell)),
            trial: SceneTrial {
                scene,
                arch: self.arch,
            },
        })
    }
}

const UNLIKE_MAPS: &str =
    "maps of glides and presses cannot be in one table; only \"cells\" and \"trace\" are possible";

fn map_table(study: &Study, cell: &Cell) -> Result<Table, ConfigError> {
    let table = map_table_of(&cell.config.scene, study.config.length_unit);
    table.map_err(|message| study.error_at(0, FieldError::at("outputs", message)))
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

struct Tasks<'s, 'a, F> {
    simulation: &'s Simulation<'a>,
    first: u64,
    make: F,
}

impl<R: Send, F: Fn(CellResults) -> R + Sync> Sweep for Tasks<'_, '_, F> {
    type Trial = CellSetup;
    type Result = R;
    type Error = ConfigError;

    fn tasks(&self) -> u64 {
        self.simulation.tasks.tasks().saturating_sub(self.first)
    }

    fn task(&self, number: u64) -> Task {
        let simulation = self.simulation;
        simulation.tasks.task(simulation.study, self.first + number)
    }

    fn set_up(&self, cell: usize) -> Result<CellSetup, ConfigError> {
        self.simulation.set_up(cell)
    }

    fn stopping_rule(&self, trial: &CellSetup) -> Option<StoppingRule> {
        trial.stop(self.simulation.study)
    }

    fn has_trial_rows(&self) -> bool {
        self.simulation.has_trials
    }

    fn add_trial_row(
        &self,
        trial: &CellSetup,
        number: u64,
        observed: Result<&TrialObservations<'_>, &'static str>,
        text: &mut String,
    ) {
        let unit = self.simulation.study.config.length_unit;
        run_files::push_trial(
            text,
            (trial.cell, number),
            trial.truth.quantities,
            unit,
            observed,
        );
    }

    fn finish(&self, cell: usize, trial: &CellSetup, mut statistics: CellStatistics) -> R {
        let quantities = trial.truth.quantities;
        drop_undefined_moments(&mut statistics.quantities, |place| {
            quantities[place].inverse_of(quantities)
        });
        (self.make)(CellResults {
            cell,
            truth: Arc::clone(&trial.truth),
            warnings: trial.warnings.clone(),
            map: trial.map.clone(),
            statistics,
        })
    }
}

impl Simulation<'_> {
    fn rows(&self, results: &CellResults) -> CellRows {
        let rows = [results.row()];
        let map = results.map.as_ref();
        CellRows {
            cell: results.cell,
            cells: run_files::cells_csv(self.study, &rows[0], self.states_bounds),
            failures: run_files::failures(&rows).rows_to_csv(),
            map: map.map_or_else(String::new, Table::rows_to_csv),
            trials: results.statistics.trials,
            kinds: results.statistics.failures.clone(),
            warnings: results.warnings.clone(),
        }
    }
}

fn warnings_of(scene: &Scene) -> Vec<Warning> {
    let needs = scene.needs().into_iter();
    let warning = |need| match need {
        Need::Warning(warning) => Some(warning),
        Need::Model(_) => None,
    };
    needs.filter_map(warning).collect()
}

/// Results of [`Simulation::run`].
#[derive(Clone, Debug, PartialEq)]
pub struct Ran {
    /// Statistics of each cell, in the order of the cell numbers.
    pub statistics: Vec<CellStatistics>,
    /// Table `cells.csv`: one row per cell and quantity.
    pub cells: Table,
    /// Table `failures.csv`: one row per cell and kind of failure.
    pub failures: Table,
    /// Table `map.csv`: the map of the first trial of every cell; `None` if the config requests no maps.
    pub map: Option<Table>,
    /// Warnings of the cells, one for each warning code.
    pub warnings: Vec<Warning>,
    /// Table of all trials as CSV text, with one row per estimate or failure; `None` without
    /// [`has_trials`](Simulation::has_trials).
    pub trials: Option<String>,
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
/// [`SweepError`] if no thread can be started, or if a cell cannot be set up.
pub fn run(study: &Study) -> Result<Ran, SweepError<ConfigError>> {
    let runner = Runner::new(&RunOptions::default())?;
    let simulation = Simulation::new(study, 0..study.cell_count(), &runner);
    let simulation = simulation.map_err(SweepError::SetUp)?;
    simulation.run(&AtomicBool::new(false), &|_| ())
}

/// Results of a cell after its last trial.
struct CellResults {
    cell: usize,
    truth: Arc<CellTruth>,
    warnings: Vec<Warning>,
    map: Option<Table>,
    /// Statistics of the cell. If the sign of the curvature is uncertain, there is no mean of a radius, because the
    /// radius may be infinite.
    statistics: CellStatistics,
}

/// Table rows of a cell, as CSV text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellRows {
    /// Number of the cell in the study.
    pub cell: usize,
    /// Rows of `cells.csv`.
    pub cells: String,
    /// Rows of `failures.csv`.
    pub failures: String,
    /// Rows of `map.csv`.
    pub map: String,
    /// Number of trials of the cell.
    pub trials: u64,
    /// Each kind of failure of the cell, with the number of trials that failed in this way.
    pub kinds: Vec<Failure>,
    /// Warnings of the cell that the check before the run did not report.
    pub warnings: Vec<Warning>,
}

impl CellResults {
    fn row(&self) -> Row<'_> {
        Row {
            cell: self.cell,
            truth: &self.truth,
            statistics: &self.statistics,
        }
    }
}
