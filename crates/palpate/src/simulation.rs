//! The trials of a study's cells, and the tables that they give.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, OnceLock, PoisonError};

use palpate_scene::{Arch, MapTable, Scene, Scenes};
use palpate_study::Table;
use palpate_study::config::{ConfigError, Output, Study};
use palpate_sweep::{CellStatistics, NoThreads, RunOptions, Runner, SweepError};
use thiserror::Error;

use crate::facts::Facts;
use crate::map::{CellMap, Map};
use crate::means;
use crate::tables::{self, Row};
use crate::trial::SceneTrial;

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
    cells: Vec<Ready>,
}

/// Cell that has been checked.
#[derive(Debug)]
struct Ready {
    number: usize,
    facts: Facts,
    /// Lines that warn of the cell.
    warnings: Vec<String>,
    /// Empty table for maps of scenes of its kind, or why there are none; `None` where the config asks for no maps.
    maps: Option<Result<MapTable, &'static str>>,
    /// Its scene, if it has been kept, until the first run takes it.
    kept: Mutex<Option<Scene>>,
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
        let numbers: Vec<usize> = numbers.into_iter().collect();
        let unit = study.config.length_unit;
        let has_maps = study.config.outputs.contains(&Output::Map);
        let checked: Vec<OnceLock<Ready>> = numbers.iter().map(|_| OnceLock::new()).collect();
        runner.check(numbers.len(), |place| {
            let number = numbers[place];
            let cell = study.cell(number)?;
            let scene = study.estimable_scene(number)?;
            checked[place].get_or_init(|| Ready {
                number,
                facts: Facts::of(&scene, cell),
                warnings: warnings_of(&scene),
                maps: has_maps.then(|| scene.map_table(unit)),
                kept: Mutex::new(Some(scene).filter(|_| place < KEPT)),
            });
            Ok::<(), ConfigError>(())
        })?;
        let simulation = Self {
            study,
            runner,
            arch: Arch::new(),
            cells: checked
                .into_iter()
                .filter_map(OnceLock::into_inner)
                .collect(),
        };
        simulation.refuse_maps()?;
        Ok(simulation)
    }

    /// The simulation with trials side by side computed by other instructions than the widest that the processor has; no
    /// number depends on them.
    #[must_use]
    pub fn with_arch(self, arch: Arch) -> Self {
        Self { arch, ..self }
    }

    /// Number of trials of all cells together; at most the largest number of 64 bits.
    pub fn trials(&self) -> u64 {
        let trials = self.cells.iter().map(|cell| cell.facts.trials);
        trials.fold(0, u64::saturating_add)
    }

    /// Lines that warn of cells in which the theory or the estimator does not hold, as `check` has them; each once, with
    /// the cells that it is of.
    pub fn warnings(&self) -> Vec<String> {
        let mut cells: Vec<(&str, usize, usize)> = Vec::new();
        let mut places: BTreeMap<&str, usize> = BTreeMap::new();
        let lines = self.cells.iter().flat_map(|cell| {
            let lines = cell.warnings.iter();
            lines.map(|line| (cell.number, line.as_str()))
        });
        for (number, line) in lines {
            let place = *places.entry(line).or_insert(cells.len());
            match cells.get_mut(place) {
                Some((.., count)) => *count += 1,
                None => cells.push((line, number, 1)),
            }
        }
        let words = |(line, first, count): (&str, usize, usize)| match (count, self.cells.len()) {
            (_, 1) => line.to_owned(),
            (1, _) => format!("{line} (cell {first})"),
            (_, all) => format!("{line} ({count} of {all} cells, the first is {first})"),
        };
        cells.into_iter().map(words).collect()
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
        let trials: Vec<u64> = self.cells.iter().map(|cell| cell.facts.trials).collect();
        let maps: Vec<OnceLock<CellMap>> = trials.iter().map(|_| OnceLock::new()).collect();
        let set_up = |place: usize| {
            let cell = &self.cells[place];
            let kept = cell
                .kept
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .take();
            let scene = match kept {
                Some(scene) => scene,
                None => self.study.estimable_scene(cell.number)?,
            };
            if let Some(Ok(table)) = &cell.maps {
                maps[place].get_or_init(|| CellMap::of(&scene, cell.number, table.clone()));
            }
            Ok(SceneTrial {
                scene,
                arch: self.arch,
            })
        };
        let mut statistics = self
            .runner
            .run_until(cancelled, &trials, set_up, progress)?;
        for (cell, statistics) in self.cells.iter().zip(&mut statistics) {
            means::withhold(cell.facts.quantities, &mut statistics.quantities);
        }
        let rows: Vec<Row<'_>> = self.cells.iter().zip(&statistics).map(Row::from).collect();
        Ok(Ran {
            cells: tables::cells(self.study, &rows),
            failures: tables::failures(&rows),
            map: self.study.config.outputs.contains(&Output::Map).then(|| {
                let maps = maps.into_iter().filter_map(OnceLock::into_inner);
                Map::of_cells(maps)
            }),
            statistics,
        })
    }

    fn refuse_maps(&self) -> Result<(), ConfigError> {
        let maps = self.cells.iter().filter_map(|cell| cell.maps.as_ref());
        let tables: Result<Vec<&MapTable>, &str> =
            maps.map(|maps| maps.as_ref().map_err(|why| *why)).collect();
        let message = match tables {
            Ok(tables) if tables.windows(2).all(|pair| pair[0] == pair[1]) => return Ok(()),
            Ok(_) => {
                "maps of glides and presses do not share a table; \"cells\" and \"trace\" are possible"
            }
            Err(message) => message,
        };
        Err(self.study.error_at(0, "outputs", message))
    }
}

/// Lines of what a scene needs that warn.
fn warnings_of(scene: &Scene) -> Vec<String> {
    let mut needs = scene.needs();
    needs.retain(|line| line.starts_with("warning: "));
    needs
}

impl<'a> From<(&'a Ready, &'a CellStatistics)> for Row<'a> {
    fn from((cell, statistics): (&'a Ready, &'a CellStatistics)) -> Self {
        Self {
            cell: cell.number,
            facts: &cell.facts,
            statistics,
        }
    }
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
