//! Implements the options `--budget` and `--target-error`: chooses the number of trials and the model, and describes
//! the choice.

use std::num::NonZeroUsize;
use std::time::Instant;

use anyhow::anyhow;
use palpate::config::{FieldError, SceneConfig};
use palpate::{ConfigError, Goal, Plan, PlanError, RunOptions, Runner, Study, Warning, Warnings};

use crate::cli::RunArgs;
use crate::duration::{exact, roughly, two_digits};
use crate::failure::Failure;

/// A study with the number of trials and the model that the program chose. `lines` describe this choice to the user.
/// `warnings` are the warnings that the planning produced.
pub(crate) struct Allowed {
    pub(crate) study: Study,
    pub(crate) lines: Vec<String>,
    pub(crate) warnings: Warnings,
}

/// Chooses the number of trials and the model. Returns `None` if `args` contain neither a budget nor a target error.
/// `numbers` are the numbers of the cells to run. `start` is the time at which planning began.
pub(crate) fn choose(
    study: &Study,
    numbers: &[usize],
    args: &RunArgs,
    start: Instant,
) -> Result<Option<Allowed>, Failure> {
    let goal = Goal {
        budget: args.budget,
        target_error: args.target_error,
    };
    if goal == Goal::default() {
        return Ok(None);
    }
    let runner = runner(args.threads)?;
    let plan = palpate::plan(study, numbers, &goal, &runner, &|| start.elapsed());
    let (study, plan) = plan.map_err(|error| refused(study, numbers, args.target_error, error))?;
    Ok(Some(Allowed {
        lines: lines(&study, &plan, args.target_error),
        warnings: warnings(&plan, numbers),
        study,
    }))
}

/// Creates a runner, which runs trials in parallel. It uses the requested number of threads, but at most one thread per
/// processor.
pub(crate) fn runner(asked: Option<NonZeroUsize>) -> Result<Runner, Failure> {
    let processors = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let threads = asked.map_or(processors, |asked| asked.min(processors));
    Runner::new(&RunOptions {
        threads: Some(threads),
        ..RunOptions::default()
    })
    .map_err(Failure::work)
}

fn refused(
    study: &Study,
    numbers: &[usize],
    target: Option<f64>,
    error: PlanError<ConfigError>,
) -> Failure {
    let at = |cell: usize, field, error| {
        let target = exact(target.unwrap_or_default());
        let message = format!("--target-error {target}: {error}");
        Failure::usage(study.error_at(numbers[cell], FieldError::at(field, message)))
    };
    match error {
        PlanError::SetUp(error) => Failure::usage(error),
        PlanError::AllFail(failing) => at(failing.cell, "scene", error),
        PlanError::TooManyTrials { cell, .. } => at(cell, "trials", error),
        PlanError::DoesNotFit {
            budget,
            least_s,
            threads,
        } => Failure::usage(anyhow!(
            "--budget: one trial of each cell does not fit into {} s; it needs about {} on {threads} threads, planning included",
            exact(budget.as_secs_f64()),
            roughly(least_s),
        )),
    }
}

fn lines(study: &Study, plan: &Plan, target: Option<f64>) -> Vec<String> {
    let trials = match plan.trials() {
        Some(trials) => Some(format!(
            "trials  {trials} per cell with random numbers: {}",
            reason(plan, target)
        )),
        None if plan.is_random => None,
        None => Some("trials  1, because no cell has random numbers".to_owned()),
    };
    let shift = plan.model_error.map_or_else(String::new, |share| {
        let share = percent(share);
        format!(": its error shifts every estimate by at most {share} of the rms error")
    });
    let model = shown(&study.config.scene).filter(|_| plan.chooses_model);
    let model = model.map(|model| format!("model   {model}{shift}"));
    trials.into_iter().chain(model).collect()
}

fn warnings(plan: &Plan, numbers: &[usize]) -> Warnings {
    let mut warnings = Warnings::default();
    for failing in &plan.failing {
        let (trials, kind) = (failing.trials, failing.kind);
        let text = format!(
            "all {trials} pilot trials of a cell fail ({kind}); such cells do not influence the number of trials"
        );
        let warning = Warning::new("failed-pilot", text, [("trials", trials as f64)]);
        warnings.add(numbers[failing.cell], &[warning]);
    }
    if let Some((cell, quantity)) = plan.heavy_tails {
        let text = format!(
            "the errors of {quantity} have heavy tails: a few trials determine their root mean square, so its stated uncertainty is rough"
        );
        warnings.add(numbers[cell], &[Warning::new("heavy-tails", text, [])]);
    }
    warnings
}

/// Text that explains the number of trials: it names the target error or the budget, and the expected error of the
/// results.
fn reason(plan: &Plan, target: Option<f64>) -> String {
    let expected = match plan.expected_error {
        Some(error) => {
            let error = percent(error);
            format!("expected standard error of the rms errors: {error}")
        }
        None => "the standard error of the rms errors cannot be predicted".to_owned(),
    };
    let rule = match (plan.by_target, plan.by_budget) {
        (Some(error), Some(time)) if time < error => {
            format!("the budget decides; the target error needs {error}")
        }
        (Some(_), Some(time)) => {
            format!("the target error decides; the budget has time for {time}")
        }
        (Some(_), None) => "the target error".to_owned(),
        (None, Some(_)) if target.is_some() => {
            "the budget decides, because it has no time for a pilot".to_owned()
        }
        (None, _) => "the budget".to_owned(),
    };
    format!("{rule}; {expected}")
}

/// The contact model of a scene as one line of TOML, which begins with the key `kind`. `None` if the scene has no
/// model.
fn shown(scene: &SceneConfig) -> Option<String> {
    let model = serde_json::to_value(scene.model()?).ok()?;
    let (kind, settings): (Vec<_>, Vec<_>) = model
        .as_object()?
        .iter()
        .partition(|(key, _)| *key == "kind");
    let keys: Vec<String> = kind
        .into_iter()
        .chain(settings)
        .map(|(key, value)| format!("{key} = {value}"))
        .collect();
    Some(format!("{{ {} }}", keys.join(", ")))
}

/// A share in percent, rounded to two significant digits.
fn percent(share: f64) -> String {
    format!("{} %", two_digits(100.0 * share))
}
