//! Choice of the number of trials and of a model's tolerance before the first trial, from a budget of time or a target
//! error.

mod clock;
mod pace;
mod pilot;
mod tolerance;

use std::num::{NonZeroU64, NonZeroUsize};
use std::time::Duration;

use thiserror::Error;

pub use clock::Clock;
pub use pace::{Pace, spread};
pub use tolerance::{Pass, PassQuantity, PassValue};

use crate::failures::NOT_FINITE;
use crate::runner::{Runner, SweepError};
use crate::trial::Trial;
use pilot::{CellPilot, Pilot};
use tolerance::{Allowance, tolerance_for};

/// Share of the target error by which the model may shift an estimate, relative to its rms error.
pub const SHARE_OF_MODEL: f64 = 0.1;
/// Most trials per cell that a target error may ask for.
const MOST_FOR_TARGET: f64 = 1e8;
/// Most trials per cell that a budget may give.
const MOST_FOR_BUDGET: NonZeroU64 = NonZeroU64::MIN.saturating_add(999_999_999_999);
/// Share of a budget that may go into timing a few trials.
const TIMING: f64 = 0.1;
/// Share of a budget that may go into a pilot.
const PILOT: f64 = 0.15;
/// Share of the budget left after planning that the run may take, as predicted.
const KEPT: f64 = 0.9;
/// Fewest trials per cell of a pilot within a budget; fewer tell nothing of the errors.
const FEWEST_OF_PILOT: u64 = 32;
/// Most trials per cell of a pilot within a budget.
const MOST_OF_PILOT: u64 = 1024;

/// Cells whose number of trials and model can be chosen.
pub trait Plannable: Sized {
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

    /// Tolerances that the model of all cells may have, largest first; none where it is given.
    fn tolerances(&self) -> &[f64];

    /// Noiseless pass of a cell whose model has this tolerance; `None` where there is none. `trial` is its experiment as it
    /// was set up.
    fn pass(&self, cell: usize, trial: &Self::Trial, tolerance: f64) -> Option<Pass>;

    /// Cells as they are to be run: with a model of this tolerance, or the model that they have.
    ///
    /// # Errors
    /// Reason why such cells cannot be made.
    fn with_tolerance(&self, tolerance: Option<f64>) -> Result<Self, Self::Error>;
}

/// Aim of a run: how long it may take, how well its error figures are known, or both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Goal {
    /// Time for planning and run together.
    pub budget: Option<Duration>,
    /// Relative standard error that every rms error may have, in (0, 1).
    pub target_error: Option<f64>,
}

/// Choice of a number of trials, and what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Whether the model's tolerance could be chosen.
    pub chooses_model: bool,
    /// Whether some cell is random; if none is, one trial of each is enough.
    pub is_random: bool,
    /// Trials of each random cell that the target error needs; `None` without a target, or without time for a pilot.
    pub by_target: Option<NonZeroU64>,
    /// Trials of each random cell that the budget has time for; `None` without a budget.
    pub by_budget: Option<NonZeroU64>,
    /// Largest relative standard error to be expected of an rms error; `None` where it is not known.
    pub expected_error: Option<f64>,
    /// Cell, and name of its quantity, whose heavy-tailed errors decided the number of trials by the target.
    pub heavy_tails: Option<(usize, &'static str)>,
    /// Cells of which every trial failed in a pilot; they have no errors to go by.
    pub failing: Vec<FailingCell>,
}

/// Cell of which every trial failed in a pilot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FailingCell {
    /// Index of the cell.
    pub cell: usize,
    /// Number of its trials in the pilot.
    pub trials: u64,
    /// Kind of failure of its first trial.
    pub kind: &'static str,
}

/// Reason why nothing can be chosen; `E` is the error of setting up a cell.
#[derive(Debug, Error)]
pub enum PlanError<E> {
    /// A cell cannot be set up.
    #[error("{0}")]
    SetUp(E),
    /// Trials cannot be timed.
    #[error(transparent)]
    Timing(#[from] SweepError),
    /// One trial of each cell does not fit into the budget.
    #[error(
        "one trial of each cell does not fit into {budget:?}; the least is about {least_s} s on {threads} threads"
    )]
    DoesNotFit {
        /// Budget that was given.
        budget: Duration,
        /// Least budget with which there is a plan, roughly, s.
        least_s: f64,
        /// Threads that it is for.
        threads: NonZeroUsize,
    },
    /// All trials of all random cells fail in a pilot.
    #[error("all {} trials of a pilot fail ({}), which leaves no error to tell", .0.trials, .0.kind)]
    AllFail(FailingCell),
    /// A target error needs more trials than are taken.
    #[error(
        "the rms error of {quantity} needs about {needed:.1e} trials, and at most {MOST_FOR_TARGET:.0e} are taken, \
         which reach {reached:.1e}{}", if *has_heavy_tails { "; its errors have heavy tails" } else { "" }
    )]
    TooManyTrials {
        /// Index of the cell that needs them.
        cell: usize,
        /// Name of the quantity whose error needs them.
        quantity: &'static str,
        /// Number of trials.
        needed: f64,
        /// Relative standard error that the most trials reach.
        reached: f64,
        /// Whether a few trials decide the error.
        has_heavy_tails: bool,
    },
}

impl Plan {
    /// Trials of each random cell, the fewer of what target error and budget say; `None` where no cell is random.
    pub fn trials(&self) -> Option<NonZeroU64> {
        let fewer = match (self.by_target, self.by_budget) {
            (Some(error), Some(time)) => Some(error.min(time)),
            (one, other) => one.or(other),
        };
        fewer.filter(|_| self.is_random)
    }
}

/// Chooses the model's tolerance and the number of trials that lead to a goal; gives the cells with that model, and the plan.
///
/// `clock` counts from the moment at which the budget begins. With a target error alone the result depends on nothing but
/// the trials' numbers.
///
/// # Errors
/// [`PlanError`].
pub fn plan<C: Plannable>(
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
    let pilot = planner.pilot(&trials, &random)?;
    let failing = match &pilot {
        Some(pilot) => planner.failing(&random, pilot)?,
        None => Vec::new(),
    };
    let tolerance = goal.target_error.and_then(|target| {
        let share = SHARE_OF_MODEL * target;
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
        planner.aim::<C>(&mut plan, &trials, &random, pilot, target)?;
    }
    // The rung that the run is going to be on.
    plan.by_budget = planner.fitting(&planned, &random)?;
    let trials = plan.trials();
    plan.expected_error = trials
        .zip(pilot)
        .and_then(|(trials, pilot)| pilot.expected_error(trials.get()));
    Ok((planned, plan))
}

/// Means of the choice.
struct Planner<'a> {
    goal: &'a Goal,
    runner: &'a Runner,
    clock: &'a Clock<'a>,
}

impl Planner<'_> {
    /// The experiments that are run; refuses where setting them up uses up the budget.
    fn set_up<C: Plannable>(&self, cells: &C) -> Result<Vec<C::Trial>, PlanError<C::Error>> {
        let mut trials = Vec::with_capacity(cells.cells());
        for cell in 0..cells.cells() {
            trials.push(cells.set_up(cell).map_err(PlanError::SetUp)?);
            let elapsed = (self.clock)();
            if let Some(budget) = self.goal.budget
                && elapsed >= budget
            {
                // Planning and the run set up each cell.
                let share = trials.len() as f64 / cells.cells() as f64;
                return Err(self.does_not_fit(budget, 2.0 * elapsed.as_secs_f64() / share));
            }
        }
        Ok(trials)
    }

    /// A pilot of the random cells, for the target or to tell what a budget will give; `None` where there is nothing to
    /// run, or no time.
    fn pilot<T: Trial>(&self, trials: &[T], random: &[usize]) -> Result<Option<Pilot>, SweepError> {
        if random.is_empty() {
            return Ok(None);
        }
        let most = match self.goal.budget {
            None => u64::MAX,
            Some(budget) => {
                let pace = self.pace(trials, budget)?;
                let each: f64 = random.iter().map(|&one| pace.seconds_per_trial(one)).sum();
                let threads = self.runner.threads().get() as f64;
                let seconds = PILOT * budget.as_secs_f64() * threads;
                ((seconds / each) as u64).min(MOST_OF_PILOT)
            }
        };
        if most < FEWEST_OF_PILOT {
            return Ok(None);
        }
        let cells: Vec<&dyn Trial> = random.iter().map(|&cell| &trials[cell] as _).collect();
        // Without a target, as many trials as the budget's share allows.
        let target = self.goal.target_error.unwrap_or(f64::MIN_POSITIVE);
        let pilot = Pilot::for_error(self.runner, &cells, target, most, MOST_FOR_TARGET);
        Ok(Some(pilot))
    }

    /// Cells of which every trial of the pilot failed. Refuses if all random cells are so and there is a target error.
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

    fn pace<T: Trial>(&self, trials: &[T], budget: Duration) -> Result<Pace, SweepError> {
        Pace::of(self.runner, trials, budget.mul_f64(TIMING), self.clock)
    }

    /// Sets the number of trials that the target needs.
    fn aim<C: Plannable>(
        &self,
        plan: &mut Plan,
        trials: &[C::Trial],
        random: &[usize],
        pilot: &Pilot,
        target: f64,
    ) -> Result<(), PlanError<C::Error>> {
        let Some(need) = pilot.need(target) else {
            // Where no estimate of the pilot errs, the run has as many trials as the pilot.
            let run = pilot.cells.iter().map(|cell| cell.trials).max();
            plan.by_target = run.and_then(NonZeroU64::new).or(Some(NonZeroU64::MIN));
            return Ok(());
        };
        let cell = random[need.cell];
        let quantity = C::quantity(&trials[cell], need.quantity);
        if need.trials > MOST_FOR_TARGET && self.goal.budget.is_none() {
            return Err(PlanError::TooManyTrials {
                cell,
                quantity,
                needed: need.trials,
                reached: target * (need.trials / MOST_FOR_TARGET).sqrt(),
                has_heavy_tails: need.is_doubtful,
            });
        }
        plan.by_target = Some(rounded(need.trials, f64::ceil));
        plan.heavy_tails = need.is_doubtful.then_some((cell, quantity));
        Ok(())
    }

    /// The most trials that the rest of the budget has time for; `None` without a budget.
    fn fitting<C: Plannable>(
        &self,
        planned: &C,
        random: &[usize],
    ) -> Result<Option<NonZeroU64>, PlanError<C::Error>> {
        let Some(budget) = self.goal.budget else {
            return Ok(None);
        };
        // The cells are set up once more by the run.
        let before = (self.clock)();
        let trials = self.set_up(planned)?;
        let setting_up = (self.clock)().saturating_sub(before);
        let pace = self.pace(&trials, budget)?;
        let threads = self.runner.threads();
        let is_random: Vec<bool> = (0..trials.len()).map(|one| random.contains(&one)).collect();
        let planning = ((self.clock)() + setting_up).as_secs_f64();
        let left = KEPT * (budget.as_secs_f64() - planning);
        match pace.most_trials(&is_random, threads, left, MOST_FOR_BUDGET) {
            Some(trials) => Ok(Some(rounded(trials.get() as f64, f64::floor))),
            None => {
                let once = pace.run_seconds(&vec![1; trials.len()], threads);
                Err(self.does_not_fit(budget, planning + once / KEPT))
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

/// Allowances of all cells; those of a pilot have its rms errors.
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

/// A number of trials to three digits; at least 1.
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
