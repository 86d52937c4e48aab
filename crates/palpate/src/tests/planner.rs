//! Tests plans for a target error or a time budget. The clock of the tests counts trials instead of time.

use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use palpate_sensing::{Channel, Stream};
use palpate_sweep::{Observation, Record, RunOptions, Runner, Trial};

use crate::planner::{
    Allowance, FailingCell, Goal, Pass, PassQuantity, PassValue, Plan, PlanError, Plannable, plan,
    tolerance_for,
};

/// Number of trials that ran in all cells. The test's clock counts one microsecond per trial.
type Run = AtomicU64;

/// Cells that estimate a quantity with the true value 1. The errors of the estimates are normally distributed with the
/// standard deviation 0.1. The error of a model is added to each estimate. `successes` states, for each cell, how many
/// of ten trials succeed.
#[derive(Clone, Debug)]
struct Cells<'a> {
    run: &'a Run,
    successes: Vec<u64>,
    model_error: f64,
}

struct Experiment<'a> {
    run: &'a Run,
    successes: u64,
}

impl Trial for Experiment<'_> {
    fn quantities(&self) -> usize {
        1
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        self.run.fetch_add(1, Ordering::Relaxed);
        let error = 0.1 * Stream::new(1, trial, Channel::Position).standard_normal();
        record.observe(0, Observation::plain(1.0 + error, 1.0));
        (trial % 10 < self.successes).then_some(()).ok_or("slipped")
    }
}

impl<'a> Plannable for Cells<'a> {
    type Trial = Experiment<'a>;
    type Error = Infallible;

    fn cells(&self) -> usize {
        self.successes.len()
    }

    fn set_up(&self, cell: usize) -> Result<Experiment<'a>, Infallible> {
        let Self { run, successes, .. } = self;
        let successes = successes[cell];
        Ok(Experiment { run, successes })
    }

    fn quantity(_: &Experiment<'a>, _: usize) -> &'static str {
        "height"
    }

    fn tolerances(&self) -> &[f64] {
        &[1e-1, 1e-2, 1e-3, 1e-4, 1e-5]
    }

    fn pass(&self, _: usize, _: &Experiment<'a>, tolerance: f64) -> Option<Pass> {
        let (scale, in_cell) = (1.0, Some(0));
        Some(Pass {
            quantities: vec![PassQuantity { scale, in_cell }],
            values: vec![PassValue {
                quantity: 0,
                estimate: 1.0 + tolerance,
                truth: 1.0,
            }],
        })
    }

    fn with_tolerance(&self, tolerance: Option<f64>) -> Result<Self, Infallible> {
        Ok(Self {
            model_error: tolerance.unwrap_or(self.model_error),
            ..self.clone()
        })
    }
}

/// Plans cells, and returns the model error of the planned cells and the plan. `successes` states, for each cell, how
/// many of ten trials succeed.
fn planned(successes: &[u64], goal: Goal) -> Result<(f64, Plan), PlanError<Infallible>> {
    let run = Run::default();
    let cells = Cells {
        run: &run,
        successes: successes.to_vec(),
        model_error: 0.0,
    };
    let threads = NonZeroUsize::new(1);
    let runner = Runner::new(&RunOptions {
        threads,
        ..RunOptions::default()
    })
    .unwrap();
    let clock = || Duration::from_micros(run.load(Ordering::Relaxed));
    let (cells, plan) = plan(&cells, &goal, &runner, &clock)?;
    Ok((cells.model_error, plan))
}

const fn target(error: f64) -> Goal {
    Goal {
        target_error: Some(error),
        budget: None,
    }
}

const fn budget(seconds: u64) -> Goal {
    Goal {
        target_error: None,
        budget: Some(Duration::from_secs(seconds)),
    }
}

#[test]
fn a_target_decides_trials_and_tolerance() {
    // For a target error of 0.02 and normally distributed errors, 1/(2 · 0.02²) = 1250 trials are needed. If half of
    // the trials fail, twice as many are needed. The planner adds a margin of at most a half.
    for (successes, least) in [(10, 1250), (5, 2500)] {
        let (model_error, plan) = planned(&[successes], target(0.02)).unwrap();
        let trials = plan.trials().unwrap().get();
        assert!((least..least * 3 / 2).contains(&trials), "{trials}");
        assert_eq!(trials % 10, 0, "{trials} has more than three digits");
        // The error of the model may be a tenth of the target error: 0.1 · 0.02 times the rms error of 0.1, which is
        // 2e-4. The largest tolerance below this value is 1e-4.
        assert_eq!((model_error, plan.by_budget), (1e-4, None));
        assert!(plan.expected_error.unwrap() <= 0.02);
    }
}

#[test]
fn a_budget_leaves_time_for_planning() {
    let (model_error, plan) = planned(&[10, 10], budget(10)).unwrap();
    let trials = plan.trials().unwrap().get();
    // Each trial takes a microsecond. Planning uses a part of the ten seconds. Two cells share nine tenths of the
    // remaining time, so about 4 million trials fit per cell.
    assert!((3_500_000..4_500_000).contains(&trials), "{trials}");
    assert_eq!((model_error, plan.by_target), (0.0, None));
    let both = Goal {
        budget: budget(10).budget,
        ..target(0.02)
    };
    let (_, plan) = planned(&[10, 10], both).unwrap();
    assert_eq!(plan.trials(), plan.by_target);
    assert!(plan.by_budget > plan.by_target);
}

#[test]
fn cells_that_always_fail_are_named() {
    let (_, plan) = planned(&[10, 0], target(0.1)).unwrap();
    let [FailingCell { cell, trials, kind }] = plan.failing[..] else {
        panic!("{plan:?}");
    };
    assert_eq!((cell, kind), (1, "slipped"));
    assert!(trials >= 64);
    let error = planned(&[0, 0], target(0.1)).unwrap_err();
    assert!(
        matches!(error, PlanError::AllFail(FailingCell { cell: 0, .. })),
        "{error}"
    );
}

#[test]
fn what_cannot_be_reached_is_refused() {
    let error = planned(&[10, 5], target(1e-6)).unwrap_err();
    let text = error.to_string();
    let PlanError::TooManyTrials {
        cell: 1,
        quantity,
        reached,
        ..
    } = error
    else {
        panic!("{text}");
    };
    assert!(
        quantity == "height" && (1e-5..2e-4).contains(&reached),
        "{text}"
    );
    let goal = Goal {
        budget: Some(Duration::from_nanos(1500)),
        target_error: None,
    };
    let error = planned(&[10; 3], goal).unwrap_err();
    assert!(matches!(error, PlanError::DoesNotFit { .. }), "{error}");
}

/// Results of a test model. The error of the model equals its tolerance; below a tolerance of 1e-5, the
/// computation fails.
fn pass_of_model(_: usize, tolerance: f64) -> Option<Pass> {
    let estimate = 2.0 + tolerance;
    let scale = 2.0;
    let in_cell = Some(0);
    (tolerance >= 1e-5).then(|| Pass {
        quantities: vec![PassQuantity { scale, in_cell }],
        values: vec![PassValue {
            quantity: 0,
            estimate,
            truth: 2.0,
        }],
    })
}

#[test]
fn the_largest_tolerance_with_an_allowed_shift_is_chosen() {
    let tolerances = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
    for (share, rms_error, expected) in [
        // If there is no rms error, or if it is 0, the contact model may shift an estimate by at most `share` ×
        // `scale`. Here the scale is 2.
        (0.1, None, 1e-1),
        (0.01, None, 1e-2),
        (0.01, Some(0.0), 1e-2),
        // If the rms error is above 0, the contact model may shift an estimate by at most `share` × rms error.
        (0.01, Some(0.2), 1e-3),
        (1e-9, Some(0.2), 1e-5),
    ] {
        let rms_errors = vec![rms_error];
        let allowances = [Allowance { share, rms_errors }];
        let found = tolerance_for(&allowances, &tolerances, pass_of_model);
        assert_eq!(found, Some(expected), "{share}, {rms_error:?}");
    }
}

#[test]
fn cells_without_a_pass_are_left_out() {
    let allowance = || Allowance {
        share: 0.01,
        rms_errors: Vec::new(),
    };
    let first = |cell: usize, tolerance| pass_of_model(cell, tolerance).filter(|_| cell == 0);
    let found = tolerance_for(&[allowance(), allowance()], &[1e-1, 1e-3], first);
    assert_eq!(found, Some(1e-3));
    assert_eq!(tolerance_for(&[allowance()], &[1e-1], |_, _| None), None);
    assert_eq!(tolerance_for(&[allowance()], &[], pass_of_model), None);
}
