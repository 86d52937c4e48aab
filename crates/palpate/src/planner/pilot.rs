//! Predicts how many trials are needed to estimate rms errors with a required precision. The prediction uses a pilot,
//! which is a small run before the actual run.
//!
//! The root mean square of N errors has the relative standard error √(v / N) / 2, where v is the relative variance of
//! a trial's squared error. If a trial has one error, v = m₄/m₂² − 1, where m₂ and m₄ are the second and fourth
//! moments of the error; v is 2 for Gaussian errors. The errors within one trial (for example at all points of a
//! patch) are dependent, so they count as one error.
//!
//! The result of a pilot depends only on its trials.

use palpate_sweep::{Batches, CellStatistics, Growth, Runner, Trial};

/// Safety margin for the relative variance v of a squared error: this number of standard errors of v is added to v.
const MARGIN: f64 = 2.0;
/// Limit for the relative standard error of v, which is the relative variance of a squared error. Above this limit, the
/// estimate of v is called rough: a few trials with very large errors determine it.
const MAX_RELATIVE_ERROR: f64 = 0.5;
/// Number of trials that a cell runs in the pilot, as a share of the number that the run needs. The pilot is a small
/// run before the actual run.
const PILOT_SHARE: f64 = 1.0 / 16.0;
/// Smallest number of trials of a cell in the first step of a pilot (a small run before the actual run).
const MIN_FIRST: u64 = 64;
/// Largest number of trials of a cell in the first step of a pilot (a small run before the actual run).
const MAX_FIRST: u64 = 1024;

#[derive(Debug)]
pub(super) struct Pilot {
    pub(super) cells: Vec<CellPilot>,
}

#[derive(Debug)]
pub(super) struct CellPilot {
    /// Share of the cell's trials that succeeded.
    pub(super) success: f64,
    pub(super) trials: u64,
    /// Kind of the first failure, if a trial failed.
    pub(super) kind: Option<&'static str>,
    /// Rms error of each quantity of the cell, with the relative variance of the squared error; `None` if no trial
    /// estimated the quantity.
    pub(super) figures: Vec<Option<Figure>>,
}

/// Estimated rms error of a quantity, and the relative variance of its squared error. This variance determines how
/// many trials are needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Figure {
    pub(super) rms_error: f64,
    /// Relative variance v of a trial's squared error, plus [`MARGIN`] standard errors of v as a safety margin.
    variance: f64,
    /// Whether the estimate of `variance` is rough, because a few trials with very large errors (heavy tails)
    /// determine it.
    pub(super) is_rough: bool,
}

/// The rms error that needs the most trials among all quantities of all cells, and the number of these trials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Need {
    pub(super) cell: usize,
    pub(super) quantity: usize,
    /// Number of trials that are needed, including the trials that are expected to fail.
    pub(super) trials: f64,
    pub(super) is_rough: bool,
}

impl Pilot {
    /// Runs a pilot to predict how many trials are needed for a relative standard error of `target`. Each cell starts
    /// with twice the number of trials that Gaussian errors would need, but with at least 64 and at most 1,024 trials.
    /// A cell that needs many trials then runs more trials: at least a sixteenth of the needed number, but at most
    /// `most`. A cell that needs more than `hopeless` trials runs no further trials.
    pub(super) fn for_error(
        runner: &Runner,
        cells: &[&dyn Trial],
        target: f64,
        most: u64,
        hopeless: f64,
    ) -> Self {
        let first = (1.0 / (target * target)).ceil();
        let first = (first as u64).clamp(MIN_FIRST, MAX_FIRST).min(most);
        let mut batches = vec![Batches::from_trial(0, None); cells.len()];
        let mut until = vec![first; cells.len()];
        loop {
            let growths = cells.iter().zip(&mut batches).zip(&until);
            let growth = |((&trial, batches), &trials)| Growth {
                trial,
                batches,
                trials,
            };
            runner.grow(growths.map(growth).collect());
            let pilot = Self {
                cells: batches.iter().map(CellPilot::of).collect(),
            };
            let mut grows = false;
            for (until, cell) in until.iter_mut().zip(&pilot.cells) {
                let need = cell.need(target).map_or(0.0, |(_, trials)| trials);
                let wanted = (PILOT_SHARE * need).ceil();
                if need <= hopeless && wanted > *until as f64 && *until < most {
                    *until = (wanted as u64).max(2 * *until).min(most);
                    grows = true;
                }
            }
            if !grows {
                return pilot;
            }
        }
    }

    /// The rms error that needs the most trials to reach a relative standard error of at most `target`. `None` if all
    /// estimates are exact.
    pub(super) fn need(&self, target: f64) -> Option<Need> {
        let needs = self.cells.iter().enumerate().filter_map(|(cell, pilot)| {
            let (quantity, trials) = pilot.need(target)?;
            let figure = pilot.figures[quantity]?;
            Some(Need {
                cell,
                quantity,
                trials,
                is_rough: figure.is_rough,
            })
        });
        needs.reduce(|most, one| if one.trials > most.trials { one } else { most })
    }

    /// Expected relative standard error of the least precise rms error, if each cell runs `trials` trials. `None` if
    /// all estimates are exact.
    pub(super) fn expected_error(&self, trials: u64) -> Option<f64> {
        // If n trials are needed for a relative standard error of 1, n/target² trials are needed for the error
        // `target`. Therefore N trials lead to the error √(n/N).
        self.need(1.0)
            .map(|need| (need.trials / trials as f64).sqrt())
    }
}

impl CellPilot {
    fn of(batches: &Batches) -> Self {
        let all = batches.statistics();
        let successes = (all.trials - all.failed()) as f64;
        let first_failure = all
            .failures
            .iter()
            .min_by_key(|failure| failure.first_trial);
        Self {
            success: successes / all.trials.max(1) as f64,
            trials: all.trials,
            kind: first_failure.map(|failure| failure.kind),
            figures: (0..all.quantities.len())
                .map(|quantity| figure(batches, &all, quantity))
                .collect(),
        }
    }

    /// Index of the cell's quantity that needs the most trials, and the number of these trials.
    fn need(&self, target: f64) -> Option<(usize, f64)> {
        let needs = self
            .figures
            .iter()
            .enumerate()
            .filter_map(|(quantity, figure)| {
                let variance = (*figure)?.variance;
                let trials = variance / (4.0 * target * target) / self.success;
                (trials > 0.0).then_some((quantity, trials))
            });
        needs.reduce(|most, one| if one.1 > most.1 { one } else { most })
    }
}

/// Rms error of a quantity, with the relative variance of its squared error; `None` if the quantity was not observed.
fn figure(batches: &Batches, all: &CellStatistics, quantity: usize) -> Option<Figure> {
    let rms_error = all.quantities[quantity].rms_error?;
    let estimate = batches.estimate(|all| Some(relative_variance(all, quantity)))?;
    let std = estimate.std_error();
    Some(Figure {
        rms_error,
        variance: estimate.value + MARGIN * std,
        is_rough: std > MAX_RELATIVE_ERROR * estimate.value,
    })
}

/// Relative variance v of a trial's squared error: the variance of the squared error, divided by the square of its
/// mean. It is 0 if all errors are 0.
fn relative_variance(all: &CellStatistics, quantity: usize) -> f64 {
    let summary = &all.quantities[quantity];
    let successes = (all.trials - all.failed()) as f64;
    match (summary.rms_error, summary.rms_error_std) {
        (Some(rms_error), Some(std)) if rms_error > 0.0 => {
            let relative = std / rms_error;
            4.0 * successes * relative * relative
        }
        _ => 0.0,
    }
}
