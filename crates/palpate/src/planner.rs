//! Chooses the number of trials and the model's tolerance before a run, from a time budget or a target error.

mod pace;
mod pilot;
mod tolerance;

use std::num::{NonZeroU64, NonZeroUsize};
use std::time::Duration;

use palpate_sweep::{Clock, Runner, Trial};
use thiserror::Error;

pub(crate) use pace::{Pace, spread};
use pilot::{CellPilot, Pilot};
pub(crate) use tolerance::{Allowance, Pass, PassQuantity, PassValue, tolerance_for};

/// Largest allowed shift of an estimate by the model's error, as a share of (target error × rms error).
const MODEL_ERROR_SHARE: f64 = 0.1;
/// Largest number of trials per cell that may be chosen to reach a target error.
const MAX_FOR_TARGET: f64 = 1e8;
/// Largest number of trials per cell that may be chosen to use a time budget.
const MAX_FOR_BUDGET: NonZeroU64 = NonZeroU64::MIN.saturating_add(999_999_999_999);
/// Share of the time budget that is used to measure the time per trial.
const TIMING_SHARE: f64 = 0.1;
/// Share of the time budget that is used for the pilot, a small run before the actual run.
const PILOT_SHARE: f64 = 0.15;
/// Share of the remaining budget that the run may use. The rest is a reserve, because the predicted run time is not
/// exact.
const RUN_SHARE: f64 = 0.9;
/// Smallest number of trials per cell in the pilot (the small run before the actual run), if there is a time budget.
/// Fewer trials cannot estimate errors.
const MIN_PILOT: u64 = 32;
/// Largest number of trials per cell in the pilot (the small run before the actual run), if there is a time budget.
const MAX_PILOT: u64 = 1024;

/// Cells for which the number of trials and the model's tolerance can be chosen.
pub(crate) trait Plannable: Sized {
    type Trial: Trial;
    type Error;

    fn cells(&self) -> usize;

    /// Sets up the simulated experiment of a cell. Its trials can then be run.
    ///
    /// # Errors
    /// Reason why the cell cannot be run.
    fn set_up(&self, cell: usize) -> Result<Self::Trial, Self::Error>;

    /// Name of the quantity with this index in an experiment.
    fn quantity(trial: &Self::Trial, quantity: usize) -> &'static str;

    /// Tolerances of the contact model that a plan may choose from, largest first. The list is empty if the config
    /// states the model.
    fn tolerances(&self) -> &[f64];

    /// Estimates and true values of a cell, computed without noise by a model with this tolerance. `trial` is the
    /// simulated experiment of the cell, as [`Self::set_up`] returned it. Returns `None` if the cell cannot be computed
    /// without noise.
    fn pass(&self, cell: usize, trial: &Self::Trial, tolerance: f64) -> Option<Pass>;

    /// Returns the same cells with a model of this tolerance. If `tolerance` is `None`, the cells use the model of the
    /// config.
    ///
    /// # Errors
    /// Reason why the cells cannot be created.
    fn with_tolerance(&self, tolerance: Option<f64>) -> Result<Self, Self::Error>;
}

/// Goal of a plan: a time budget, a target error, or both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Goal {
    /// Time limit for the planning and the run together.
    pub budget: Option<Duration>,
    /// Largest allowed relative standard error of every rms error, in (0, 1).
    pub target_error: Option<f64>,
}

/// The number of trials that was chosen for a run, with the reasons for this choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Whether the plan also chose the model's tolerance; false if the config states the model.
    pub chooses_model: bool,
    /// Largest allowed shift of an estimate by the error of the chosen model, relative to the rms error. `None` without
    /// a target error.
    pub model_error: Option<f64>,
    /// Whether at least one cell uses random numbers. A cell without random numbers needs only one trial.
    pub is_random: bool,
    /// Number of trials that the target error requires in each cell with random numbers. `None` without a target error,
    /// or if there was no time for a pilot (a small run before the actual run).
    pub by_target: Option<NonZeroU64>,
    /// Number of trials that the budget allows in each cell with random numbers; `None` without a budget.
    pub by_budget: Option<NonZeroU64>,
    /// Expected relative standard error of the least precise rms error of the run; `None` if it could not be estimated.
    pub expected_error: Option<f64>,
    /// Index of the cell and name of the quantity that require the most trials; `None` unless the errors of this
    /// quantity have heavy tails. With heavy tails, a few trials with very large errors determine the rms error.
    pub heavy_tails: Option<(usize, &'static str)>,
    /// Cells for which no errors could be estimated, because every trial of the pilot (the small run before the actual
    /// run) failed.
    pub failing: Vec<FailingCell>,
}

/// A cell in which every trial of the pilot (the small run before the actual run) failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FailingCell {
    /// Index of the cell.
    pub cell: usize,
    /// Number of trials of the cell in the pilot, the small run before the actual run.
    pub trials: u64,
    /// Kind of failure of the cell's first trial.
    pub kind: &'static str,
}

/// Reason why planning failed. `E` is the type of error that setting up a cell can return.
#[derive(Debug, Error)]
pub enum PlanError<E> {
    /// A cell cannot be set up.
    #[error("{0}")]
    SetUp(E),
    /// One trial of each cell does not fit into the budget.
    #[error(
        "one trial of each cell does not fit into {budget:?}; it needs about {least_s} s on {threads} threads"
    )]
    DoesNotFit {
        /// The stated time budget.
        budget: Duration,
        /// Approximate smallest budget in which one trial of each cell fits, s.
        least_s: f64,
        /// Number of threads that `least_s` assumes.
        threads: NonZeroUsize,
    },
    /// In the pilot (the small run before the actual run), all trials of all cells with random numbers failed.
    #[error("all {} trials of a pilot fail ({}), so no error can be estimated", .0.trials, .0.kind)]
    AllFail(FailingCell),
    /// The target error requires more trials than the allowed maximum.
    #[error(
        "the rms error of {quantity} needs about {needed:.1e} trials; the maximum of {MAX_FOR_TARGET:.0e} reaches {reached:.1e}{}", if *has_heavy_tails { "; its errors have heavy tails" } else { "" }
    )]
    TooManyTrials {
        /// Index of the cell that needs the most trials.
        cell: usize,
        /// Name of the quantity that needs the most trials.
        quantity: &'static str,
        /// Required number of trials.
        needed: f64,
        /// Relative standard error of the rms error, if the largest allowed number of trials is run.
        reached: f64,
        /// Whether a few trials with very large errors (heavy tails) determine the rms error of the quantity.
        has_heavy_tails: bool,
    },
}

impl Plan {
    /// Number of trials of each cell with random numbers. If both a target error and a budget state a number, this is
    /// the smaller number. `None` if no cell uses random numbers.
    pub fn trials(&self) -> Option<NonZeroU64> {
        let fewer = match (self.by_target, self.by_budget) {
            (Some(error), Some(time)) => Some(error.min(time)),
            (one, other) => one.or(other),
        };
        fewer.filter(|_| self.is_random)
    }
}

/// Chooses the model's tolerance and the number of trials for a goal. Returns a copy of the cells with this tolerance,
/// and the plan.
///
/// `clock` returns the time since planning began. Without a budget, the plan depends only on the trials and not on the
/// clock.
///
/// # Errors
/// [`PlanError`] if no plan reaches the goal, or if a cell cannot be set up.
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
    let model_error = goal.target_error.map(|target| MODEL_ERROR_SHARE * target);
    let tolerance = model_error.and_then(|share| {
        let allowances = allowances(trials.len(), &random, pilot.as_ref(), share);
        tolerance_for(&allowances, cells.tolerances(), |cell, tolerance| {
            cells.pass(cell, &trials[cell], tolerance)
        })
    });
    let planned = cells.with_tolerance(tolerance).map_err(PlanError::SetUp)?;
    let mut plan = Plan {
        chooses_model: !cells.tolerances().is_empty(),
        model_error,
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
    // The time per trial depends on the model, so the model is chosen before the time is measured.
    plan.by_budget = planner.by_budget(&planned, &random)?;
    let trials = plan.trials();
    plan.expected_error = trials
        .zip(pilot)
        .and_then(|(trials, pilot)| pilot.expected_error(trials.get()));
    Ok((planned, plan))
}

/// Makes a plan for a goal. Measures times with the runner and the clock.
struct Planner<'a> {
    goal: &'a Goal,
    runner: &'a Runner,
    clock: &'a Clock<'a>,
}

impl Planner<'_> {
    /// Sets up the experiments of all cells. Returns an error if this takes the whole budget.
    fn set_up<C: Plannable>(&self, cells: &C) -> Result<Vec<C::Trial>, PlanError<C::Error>> {
        let mut trials = Vec::with_capacity(cells.cells());
        for cell in 0..cells.cells() {
            trials.push(cells.set_up(cell).map_err(PlanError::SetUp)?);
            let elapsed = (self.clock)();
            if let Some(budget) = self.goal.budget
                && elapsed >= budget
            {
                // Multiply the time by 2, because each cell is set up twice: once for planning and once for the run.
                let share = trials.len() as f64 / cells.cells() as f64;
                return Err(self.does_not_fit(budget, 2.0 * elapsed.as_secs_f64() / share));
            }
        }
        Ok(trials)
    }

    /// Runs a pilot (a small run before the actual run) with the cells in `random`, which use random numbers. With a
    /// target error, the pilot estimates how many trials are needed; otherwise it predicts the errors of the run.
    /// Returns `None` if no cell is random, or if the budget is too small.
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
        // The pilot is a small run before the actual run. If no target error is stated, use a tiny one, so that the
        // pilot runs as many trials as the budget allows.
        let target = self.goal.target_error.unwrap_or(f64::MIN_POSITIVE);
        let pilot = Pilot::for_error(self.runner, &cells, target, most, MAX_FOR_TARGET);
        Some(pilot)
    }

    /// Cells in which every trial of the pilot (a small run before the actual run) failed. Returns an error if the goal
    /// has a target error and all cells with random numbers fail.
    fn failing<E>(
        &self,
        random: &[usize],
        pilot: &Pilot,
    ) -> Result<Vec<FailingCell>, PlanError<E>> {
        let all_fail = |(pilot, &cell): (&CellPilot, &usize)| {
            let kind = pilot.kind.filter(|_| pilot.success == 0.0)?;
            let trials = pilot.trials;
            Some(FailingCell { cell, trials, kind })
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

    fn set_by_target<C: Plannable>(
        &self,
        plan: &mut Plan,
        trials: &[C::Trial],
        random: &[usize],
        pilot: &Pilot,
        target: f64,
    ) -> Result<(), PlanError<C::Error>> {
        let Some(need) = pilot.need(target) else {
            // All estimates in the pilot (the small run before the actual run) are exact, so more trials are not
            // needed. Use the same number of trials as the pilot.
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

    /// Largest number of trials per cell that fits into the remaining budget; `None` without a budget.
    fn by_budget<C: Plannable>(
        &self,
        planned: &C,
        random: &[usize],
    ) -> Result<Option<NonZeroU64>, PlanError<C::Error>> {
        let Some(budget) = self.goal.budget else {
            return Ok(None);
        };
        // Measure the time of setting up the cells, because the run sets them up again.
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

/// For each cell, the largest allowed shift of an estimate by the error of the contact model. It is a share of the rms
/// error, if the pilot (a small run before the actual run) estimated the rms error.
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

/// Rounds a number of trials to three significant digits. The result is at least 1.
fn rounded(trials: f64, round: fn(f64) -> f64) -> NonZeroU64 {
    let unit = libm::pow(10.0, (libm::log10(trials).floor() - 2.0).max(0.0));
    let whole = round(trials / unit) * unit;
    NonZeroU64::new(whole as u64).unwrap_or(NonZeroU64::MIN)
}
