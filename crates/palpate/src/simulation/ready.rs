//! Cells that have been set up.

use std::ops::Range;
use std::sync::Arc;

use palpate_study::Quantity;
use palpate_study::config::{StopStatistic, Study};
use palpate_sweep::{Record, StoppingRule, StoppingStatistic, Trial};

use crate::facts::Facts;
use crate::map::CellMap;
use crate::trial::SceneTrial;

/// Cell that is ready to be run.
#[derive(Debug)]
pub(super) struct Ready {
    pub(super) cell: usize,
    pub(super) trial: SceneTrial,
    pub(super) facts: Arc<Facts>,
    pub(super) warnings: Vec<String>,
    pub(super) map: Option<CellMap>,
}

impl Ready {
    /// Rule of its study by which it has had enough trials.
    pub(super) fn stop(&self, study: &Study) -> Option<StoppingRule> {
        stop_of(study, self.facts.quantities)
    }
}

impl Trial for Ready {
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

/// Rule of a study by which a cell that observes these quantities has had enough trials; one that has no such quantity runs
/// to its end.
fn stop_of(study: &Study, quantities: &[Quantity]) -> Option<StoppingRule> {
    let rule = study.config.stop.as_ref()?;
    let quantity = match &rule.quantity {
        None => 0,
        Some(name) => quantities.iter().position(|one| one.name == name)?,
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
