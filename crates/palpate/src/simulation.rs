//! The trials of a study's cells, and the tables that they give.

use std::sync::atomic::AtomicBool;

use palpate_scene::{Arch, MapTable, Scene, Scenes};
use palpate_study::Table;
use palpate_study::config::{ConfigError, Output, Study};
use palpate_sweep::{Cell, CellStatistics, RunOptions, Runner, SweepError};

use crate::SceneTrial;
use crate::tables::{self, Row};

/// Cells of a study that are ready to run.
#[derive(Debug)]
pub struct Simulation<'a> {
    study: &'a Study,
    numbers: Vec<usize>,
    trials: Vec<SceneTrial>,
}

impl<'a> Simulation<'a> {
    /// Sets up the cells with these numbers.
    ///
    /// # Errors
    /// A [`ConfigError`] at the field that makes no scene, that leaves nothing to estimate from, or that asks for a map of
    /// what has none.
    ///
    /// # Panics
    /// If a number is not that of a cell.
    pub fn new(
        study: &'a Study,
        numbers: impl IntoIterator<Item = usize>,
    ) -> Result<Self, ConfigError> {
        let numbers: Vec<usize> = numbers.into_iter().collect();
        let trials = numbers
            .iter()
            .map(|&cell| study.estimable_scene(cell).map(SceneTrial::new))
            .collect::<Result<Vec<_>, _>>()?;
        let simulation = Self {
            study,
            numbers,
            trials,
        };
        simulation.refuse_maps()?;
        Ok(simulation)
    }

    /// The simulation with trials side by side computed by other instructions than the widest that the processor has; no
    /// number depends on them.
    #[must_use]
    pub fn with_arch(mut self, arch: Arch) -> Self {
        for trial in &mut self.trials {
            trial.arch = arch;
        }
        self
    }

    /// Scenes of the cells, in the order of their numbers.
    pub fn scenes(&self) -> impl Iterator<Item = &Scene> {
        self.trials.iter().map(|trial| &trial.scene)
    }

    /// Number of trials of all cells together; at most the largest number of 64 bits.
    pub fn trials(&self) -> u64 {
        let trials = self.cells().into_iter().map(|cell| cell.trials);
        trials.fold(0, u64::saturating_add)
    }

    /// Runs all trials; `progress` is told by any thread how many it has done since it last told.
    ///
    /// # Errors
    /// [`SweepError`], before any trial is run.
    ///
    /// # Panics
    /// Where `progress` does.
    pub fn run(
        &self,
        options: &RunOptions,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Ran<'_>, SweepError> {
        self.run_until(&AtomicBool::new(false), options, progress)
    }

    /// Runs all trials as [`Simulation::run`] does, until another thread sets `cancelled`: then no trial begins.
    ///
    /// # Errors
    /// [`SweepError`], before any trial is run; [`SweepError::Cancelled`].
    ///
    /// # Panics
    /// Where `progress` does.
    pub fn run_until(
        &self,
        cancelled: &AtomicBool,
        options: &RunOptions,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Ran<'_>, SweepError> {
        let statistics = Runner::new(options)?.run_until(cancelled, &self.cells(), progress)?;
        Ok(Ran {
            simulation: self,
            statistics,
        })
    }

    fn cells(&self) -> Vec<Cell<'_>> {
        let cells = self.numbers.iter().zip(&self.trials);
        cells
            .map(|(&number, trial)| Cell {
                trials: trial.scene.trials(self.study.cells[number].config.trials),
                trial,
            })
            .collect()
    }

    fn refuse_maps(&self) -> Result<(), ConfigError> {
        if !self.study.config.outputs.contains(&Output::Map) {
            return Ok(());
        }
        let unit = self.study.config.length_unit;
        let tables: Result<Vec<MapTable>, &str> =
            self.scenes().map(|scene| scene.map_table(unit)).collect();
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

/// Results of the trials of a [`Simulation`].
#[derive(Debug)]
pub struct Ran<'a> {
    simulation: &'a Simulation<'a>,
    /// Statistics of each cell, in the order of their numbers.
    pub statistics: Vec<CellStatistics>,
}

/// Maps, or profiles, of the first trial of every cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// CSV text of all of them.
    pub csv: String,
    /// Name of what may be missing in it: "cells" or "estimates of cells".
    pub lacks: &'static str,
    /// Numbers of the cells whose trial 0 failed, and the stable name of how.
    pub failed: Vec<(usize, &'static str)>,
}

impl Ran<'_> {
    fn rows(&self) -> Vec<Row<'_>> {
        let Simulation {
            numbers, trials, ..
        } = self.simulation;
        let cells = numbers.iter().zip(trials).zip(&self.statistics);
        cells
            .map(|((&cell, trial), statistics)| Row {
                cell,
                scene: &trial.scene,
                statistics,
            })
            .collect()
    }

    /// `cells.csv`: one row per cell and quantity.
    pub fn cells(&self) -> Table {
        tables::cells(self.simulation.study, &self.rows())
    }

    /// `failures.csv`: one row per cell and kind of failure.
    pub fn failures(&self) -> Table {
        tables::failures(&self.rows())
    }

    /// `map.csv`: the map of the first trial of every cell, where the config asks for it.
    pub fn map(&self) -> Option<Map> {
        let study = self.simulation.study;
        if !study.config.outputs.contains(&Output::Map) {
            return None;
        }
        let rows = self.rows();
        let first = rows.first()?.scene;
        let mut table = first.map_table(study.config.length_unit).ok()?;
        let mut failed = Vec::new();
        for Row { cell, scene, .. } in rows {
            if let Err(name) = scene.map(cell, 0, &mut table) {
                failed.push((cell, name));
            }
        }
        Some(Map {
            lacks: table.lacks,
            csv: table.into_csv(),
            failed,
        })
    }
}
