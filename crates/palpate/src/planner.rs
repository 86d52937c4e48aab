//! Choice of the number of trials and of a model's tolerance before the first trial, from a budget of time or a target
//! error.

mod pace;
mod pilot;
mod tolerance;

use std::num::{NonZeroU64, NonZeroUsize};
use std::time::Duration;

use palpate_sweep::{Clock, NOT_FINITE, Runner, Trial};
use thiserror::Error;

pub(crate) use pace::{Pace, spread};
use pilot::{CellPilot, Pilot};
use tolerance::{Allowance, tolerance_for};
pub(crate) use tolerance::{Pass, PassQuantity, PassValue};

/// Largest shift of an estimate by the model's error, as a share of target error × rms error.
pub const MODEL_ERROR_SHARE: f64 = 0.1;
/// Largest number of trials per cell for a target error.
const MAX_FOR_TARGET: f64 = 1e8;
/// Largest number of trials per cell for a budget.
const MAX_FOR_BUDGET: NonZeroU64 = NonZeroU64::MIN.saturating_add(999_999_999_999);
/// Share of a budget for timing a few trials.
const TIMING_SHARE: f64 = 0.1;
/// Share of a budget for a pilot.
const PILOT_SHARE: f64 = 0.15;
/// Predicted time of the run, as a share of the budget left after planning.
const RUN_SHARE: f64 = 0.9;
/// Smallest number of trials per cell of a pilot within a budget. With fewer, errors cannot be estimated.
const MIN_PILOT: u64 = 32;
/// Largest number of trials per cell of a pilot within a budget.
const MAX_PILOT: u64 = 1024;

/// Cells whose number of trials and model can be chosen.
pub(crate) trait Plannable: Sized {
    /// Experiment of a cell.
    type Trial: Trial;
    /// Error of setting up an experiment.
    type Error;

    /// Number of cells.
    fn cells(&self) -> usize;

    /// Sets up the experiment of a cell.
    ///
    /// # Errors
    /// Reason why the cell cannot be run.
    fn set_up(&self, cell: usize) -> Result<Self::Trial, Self::Error>;

    /// Name of a quantity that an experiment observes.
    fn quantity(trial: &Self::Trial, quantity: usize) -> &'static str;

    /// Possible tolerances of the model of all cells, largest first; empty if the config states the model.
    fn tolerances(&self) -> &[f64];

    /// Noiseless pass of a cell whose model has this tolerance; `None` if the cell has no such pass. `trial` is the
    /// experiment of the cell.
    fn pass(&self, cell: usize, trial: &Self::Trial, tolerance: f64) -> Option<Pass>;

    /// The cells to run: with a model of this tolerance, or with the model of the config.
    ///
    /// # Errors
    /// Reason why the cells cannot be made.
    fn with_tolerance(&self, tolerance: Option<f64>) -> Result<Self, Self::Error>;
}

/// Aim of a run: its time, the precision of its error figures, or both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Goal {
    /// Time for planning and run together.
    pub budget: Option<Duration>,
    /// Largest relative standard error of every rms error, in (0, 1).
    pub target_error: Option<f64>,
}

/// Chosen number of trials, and the reasons for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Whether the model's tolerance could be chosen.
    pub chooses_model: bool,
    /// Whether at least one cell is random. If none is, one trial of each cell is enough.
    pub is_random: bool,
    /// Number of trials of each random cell for the target error; `None` without a target, or without time for a pilot.
    pub by_target: Option<NonZeroU64>,
    /// Number of trials of each random cell for the budget; `None` without a budget.
    pub by_budget: Option<NonZeroU64>,
    /// Largest expected relative standard error of an rms error; `None` without an estimate.
    pub expected_error: Option<f64>,
    /// Cell and name of the quantity whose heavy-tailed errors determined `by_target`.
    pub heavy_tails: Option<(usize, &'static str)>,
    /// Cells in which every trial of the pilot failed, so that they have no errors.
    pub failing: Vec<FailingCell>,
}

/// Cell in which every trial of a pilot failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FailingCell {
    /// Index of the cell.
    pub cell: usize,
    /// Number of its trials in the pilot.
    pub trials: u64,
    /// Kind of failure of its first trial.
    pub kind: &'static str,
}

/// Reason why there is no plan; `E` is the error of setting up a cell.
#[derive(Debug, Error)]
pub enum PlanError<E> {
    /// A cell cannot be set up.
    #[error("{0}")]
    SetUp(E),
    /// One trial of each cell does not fit into the budget.
    #[error(
        "one trial of each cell does not fit into {budget:?}; the least is about {least_s} s on {threads} threads"
    )]
    DoesNotFit {
        /// The budget.
        budget: Duration,
        /// Approximate smallest budget for which there is a plan, s.
        least_s: f64,
        /// Number of threads for that budget.
        threads: NonZeroUsize,
    },
    /// All trials of all random cells fail in a pilot.
    #[error("all {} trials of a pilot fail ({}), so no error can be estimated", .0.trials, .0.kind)]
    AllFail(FailingCell),
    /// A target error needs more trials than the largest number.
    #[error(
        "the rms error of {quantity} needs about {needed:.1e} trials; the maximum of {MAX_FOR_TARGET:.0e} \
         reaches {reached:.1e}{}", if *has_heavy_tails { "; its errors have heavy tails" } else { "" }
    )]
    TooManyTrials {
        /// Index of the cell that needs them.
        cell: usize,
        /// Name of the quantity whose error needs them.
        quantity: &'static str,
        /// Number of trials.
        needed: f64,
        /// Relative standard error with the largest number of trials.
        reached: f64,
        /// Whether a few trials determine the error.
        has_heavy_tails: bool,
    },
}

impl Plan {
    /// Number of trials of each random cell: the smaller of the numbers for target error and budget. `None` if no cell
    /// is random.
    pub fn trials(&self) -> Option<NonZeroU64> {
        let fewer = match (self.by_target, self.by_budget) {
            (Some(error), Some(time)) => Some(error.min(time)),
            (one, other) => one.or(other),
        };
        fewer.filter(|_| self.is_random)
    }
}

/// Chooses the model's tolerance and the number of trials for a goal. Returns the cells with that model, and the plan.
///
/// `clock` counts from the start of the budget. Without a budget the result depends only on the trials.
///
/// # Errors
/// [`PlanError`].
pub(crate) fn plan<C: Plannable>(
    cells: &C,
    goal: &Goal,
    runner: &Runner,
    clock: &Clock<'_>,
) -> Result<(C, Plan), PlanError<C::Error>> {
    let planner = Planner {
        goal,
        runner,
        clock,
    };
    let trials = planner.set_up(cells)?;
    let random: Vec<usize> = (0..trials.len())
        .filter(|&cell| trials[cell].is_random())
        .collect();
    let pilot = planner.pilot(&trials, &random);
    let failing = match &pilot {
        Some(pilot) => planner.failing(&random, pilot)?,
        None => Vec::new(),
    };
    let tolerance = goal.target_error.and_then(|target| {
        let share = MODEL_ERROR_SHARE * target;
        let allowances = allowances(trials.len(), &random, pilot.as_ref(), share);
        tolerance_for(&allowances, cells.tolerances(), |cell, tolerance| {
            cells.pass(cell, &trials[cell], tolerance)
        })
    });
    let planned = cells.with_tolerance(tolerance).map_err(PlanError::SetUp)?;
    let mut plan = Plan {
        chooses_model: !cells.tolerances().is_empty(),
        is_random: !random.is_empty(),
        by_target: None,
        by_budget: None,
        expected_error: None,
        heavy_tails: None,
        failing,
    };
    if let (Some(pilot), Some(target)) = (&pilot, goal.target_error) {
        planner.set_by_target::<C>(&mut plan, &trials, &random, pilot, target)?;
    }
    // The run will use this model, so it is timed.
    plan.by_budget = planner.by_budget(&planned, &random)?;
    let trials = plan.trials();
    plan.expected_error = trials
        .zip(pilot)
        .and_then(|(trials, pilot)| pilot.expected_error(trials.get()));
    Ok((planned, plan))
}

/// Goal, threads and clock of a plan.
struct Planner<'a> {
    goal: &'a Goal,
    runner: &'a Runner,
    clock: &'a Clock<'a>,
}

impl Planner<'_> {
    /// Sets up the experiments of all cells. Fails if this uses up the budget.
    fn set_up<C: Plannable>(&self, cells: &C) -> Result<Vec<C::Trial>, PlanError<C::Error>> {
        let mut trials = Vec::with_capacity(cells.cells());
        for cell in 0..cells.cells() {
            trials.push(cells.set_up(cell).map_err(PlanError::SetUp)?);
            let elapsed = (self.clock)();
            if let Some(budget) = self.goal.budget
                && elapsed >= budget
            {
                // Each cell is set up twice: for planning and for the run.
                let share = trials.len() as f64 / cells.cells() as f64;
                return Err(self.does_not_fit(budget, 2.0 * elapsed.as_secs_f64() / share));
            }
        }
        Ok(trials)
    }

    /// Pilot of the random cells: for the target error, or to predict the errors within a budget. `None` without random
    /// cells or without time.
    fn pilot<T: Trial>(&self, trials: &[T], random: &[usize]) -> Option<Pilot> {
        if random.is_empty() {
            return None;
        }
        let most = match self.goal.budget {
            None => u64::MAX,
            Some(budget) => {
                let pace = self.pace(trials, budget);
                let each: f64 = random.iter().map(|&one| pace.seconds_per_trial(one)).sum();
                let threads = self.runner.threads().get() as f64;
                let seconds = PILOT_SHARE * budget.as_secs_f64() * threads;
                ((seconds / each) as u64).min(MAX_PILOT)
            }
        };
        if most < MIN_PILOT {
            return None;
        }
        let cells: Vec<&dyn Trial> = random.iter().map(|&cell| &trials[cell] as _).collect();
        // Without a target, as many trials as the budget's share allows.
        let target = self.goal.target_error.unwrap_or(f64::MIN_POSITIVE);
        let pilot = Pilot::for_error(self.runner, &cells, target, most, MAX_FOR_TARGET);
        Some(pilot)
    }

    /// Cells in which every trial of the pilot failed. Returns an error if these are all random cells and there is a
    /// target error.
    fn failing<E>(
        &self,
        random: &[usize],
        pilot: &Pilot,
    ) -> Result<Vec<FailingCell>, PlanError<E>> {
        let all_fail = |(pilot, &cell): (&CellPilot, &usize)| {
            (pilot.success == 0.0).then(|| FailingCell {
                cell,
                trials: pilot.trials,
                kind: pilot.kind.unwrap_or(NOT_FINITE),
            })
        };
        let failing: Vec<FailingCell> = pilot
            .cells
            .iter()
            .zip(random)
            .filter_map(all_fail)
            .collect();
        match failing.first() {
            Some(&first) if self.goal.target_error.is_some() && failing.len() == random.len() => {
                Err(PlanError::AllFail(first))
            }
            _ => Ok(failing),
        }
    }

    fn pace<T: Trial>(&self, trials: &[T], budget: Duration) -> Pace {
        Pace::of(
            self.runner,
            trials,
            budget.mul_f64(TIMING_SHARE),
            self.clock,
        )
    }

    /// Sets the number of trials that the target needs.
    fn set_by_target<C: Plannable>(
        &self,
        plan: &mut Plan,
        trials: &[C::Trial],
        random: &[usize],
        pilot: &Pilot,
        target: f64,
    ) -> Result<(), PlanError<C::Error>> {
        let Some(need) = pilot.need(target) else {
            // If no estimate of the pilot has an error, the run has as many trials as the pilot.
            let run = pilot.cells.iter().map(|cell| cell.trials).max();
            plan.by_target = run.and_then(NonZeroU64::new).or(Some(NonZeroU64::MIN));
            return Ok(());
        };
        let cell = random[need.cell];
        let quantity = C::quantity(&trials[cell], need.quantity);
        if need.trials > MAX_FOR_TARGET && self.goal.budget.is_none() {
            return Err(PlanError::TooManyTrials {
                cell,
                quantity,
                needed: need.trials,
                reached: target * (need.trials / MAX_FOR_TARGET).sqrt(),
                has_heavy_tails: need.is_rough,
            });
        }
        plan.by_target = Some(rounded(need.trials, f64::ceil));
        plan.heavy_tails = need.is_rough.then_some((cell, quantity));
        Ok(())
    }

    /// Largest number of trials for which the rest of the budget has time; `None` without a budget.
    fn by_budget<C: Plannable>(
        &self,
        planned: &C,
        random: &[usize],
    ) -> Result<Option<NonZeroU64>, PlanError<C::Error>> {
        let Some(budget) = self.goal.budget else {
            return Ok(None);
        };
        // The run sets up the cells again.
        let before = (self.clock)();
        let trials = self.set_up(planned)?;
        let setting_up = (self.clock)().saturating_sub(before);
        let pace = self.pace(&trials, budget);
        let threads = self.runner.threads();
        let is_random: Vec<bool> = (0..trials.len()).map(|one| random.contains(&one)).collect();
        let planning = ((self.clock)() + setting_up).as_secs_f64();
        let left = RUN_SHARE * (budget.as_secs_f64() - planning);
        match pace.most_trials(&is_random, threads, left, MAX_FOR_BUDGET) {
            Some(trials) => Ok(Some(rounded(trials.get() as f64, f64::floor))),
            None => {
                let once = pace.run_seconds(&vec![1; trials.len()], threads);
                Err(self.does_not_fit(budget, planning + once / RUN_SHARE))
            }
        }
    }

    fn does_not_fit<E>(&self, budget: Duration, least_s: f64) -> PlanError<E> {
        PlanError::DoesNotFit {
            budget,
            least_s: 1.1 * least_s.max(budget.as_secs_f64()),
            threads: self.runner.threads(),
        }
    }
}

/// Allowances of all cells, with the rms errors of the cells in the pilot.
fn allowances(cells: usize, random: &[usize], pilot: Option<&Pilot>, share: f64) -> Vec<Allowance> {
    let rms_errors = |cell: usize| {
        let found = random.iter().position(|&one| one == cell);
        let cell = found.and_then(|found| pilot?.cells.get(found))?;
        let figures = cell.figures.iter();
        Some(
            figures
                .map(|figure| Some(figure.as_ref()?.rms_error))
                .collect(),
        )
    };
    (0..cells)
        .map(|cell| Allowance {
            share,
            rms_errors: rms_errors(cell).unwrap_or_default(),
        })
        .collect()
}

/// Number of trials, rounded to three digits; at least 1.
fn rounded(trials: f64, round: fn(f64) -> f64) -> NonZeroU64 {
    let unit = libm::pow(10.0, (libm::log10(trials).floor() - 2.0).max(0.0));
    let whole = round(trials / unit) * unit;
    NonZeroU64::new(whole as u64).unwrap_or(NonZeroU64::MIN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trials_have_three_digits() {
        for (trials, up, down) in [
            (0.2, 1, 1),
            (7.5, 8, 7),
            (123.0, 123, 123),
            (1234.0, 1240, 1230),
            (99_999.0, 100_000, 99_900),
            (1e8, 100_000_000, 100_000_000),
        ] {
            assert_eq!(rounded(trials, f64::ceil).get(), up);
            assert_eq!(rounded(trials, f64::floor).get(), down);
        }
    }
}
