//! Sets up cells: their scene, true values, map and stopping rule.

use std::ops::Range;
use std::sync::Arc;

use palpate_scene::{Scene, SceneTrial};
use palpate_study::config::{Cell, StopStatistic, Study};
use palpate_study::{Quantity, Table, Warning};
use palpate_sweep::{Record, StoppingRule, StoppingStatistic, Trial};

#[derive(Debug)]
pub(super) struct CellSetup {
    pub(super) cell: usize,
    pub(super) trial: SceneTrial,
    pub(super) truth: Arc<CellTruth>,
    pub(super) warnings: Vec<Warning>,
    pub(super) map: Option<Table>,
}

impl CellSetup {
    /// The study's stopping rule, if it applies to this cell. `None` if the study has no rule, or if the cell does not
    /// have the quantity of the rule.
    pub(super) fn stop(&self, study: &Study) -> Option<StoppingRule> {
        let rule = study.config.stop.as_ref()?;
        let quantity = match &rule.quantity {
            None => 0,
            Some(name) => self
                .truth
                .quantities
                .iter()
                .position(|one| one.name == name)?,
        };
        Some(StoppingRule {
            quantity,
            statistic: match rule.statistic {
                StopStatistic::Mean => StoppingStatistic::Mean,
                StopStatistic::RmsError => StoppingStatistic::RmsError,
                StopStatistic::MeanAbsError => StoppingStatistic::MeanAbsError,
            },
            relative_standard_error: rule.relative_standard_error,
            min_trials: rule.min_trials,
        })
    }
}

impl Trial for CellSetup {
    fn quantities(&self) -> usize {
        self.trial.quantities()
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        self.trial.run(trial, record)
    }

    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        self.trial.run_together(trials, record)
    }

    fn is_random(&self) -> bool {
        self.trial.is_random()
    }
}

/// True values of a cell, and lower bounds on the standard deviations of its estimates. Both are the same for all
/// trials.
#[derive(Clone, Debug)]
pub(crate) struct CellTruth {
    pub(crate) coordinates: Vec<String>,
    pub(crate) quantities: &'static [Quantity],
    /// True value of each quantity; `None` if the true value differs from point to point of a patch.
    pub(crate) truths: Vec<Option<f64>>,
    /// Lower bound on the standard deviation of an unbiased estimate of each quantity; `None` if there is no such
    /// bound.
    pub(crate) std_bounds: Vec<Option<f64>>,
}

impl CellTruth {
    /// Data of a cell that is not set up. They contain the swept values, but all true values and bounds are `None`.
    pub(crate) fn unknown(cell: &Cell, quantities: &'static [Quantity]) -> Self {
        let none = vec![None; quantities.len()];
        Self {
            coordinates: cell.coordinates.clone(),
            quantities,
            truths: none.clone(),
            std_bounds: none,
        }
    }

    pub(super) fn new(scene: &Scene, cell: Cell) -> Self {
        let quantities = scene.quantities();
        let places = 0..quantities.len();
        Self {
            coordinates: cell.coordinates,
            quantities,
            truths: places.clone().map(|place| scene.truth(place)).collect(),
            std_bounds: places.map(|place| scene.std_bound(place)).collect(),
        }
    }
}
