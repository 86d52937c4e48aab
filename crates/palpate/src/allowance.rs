//! Choice of the number of trials and of a model's rung before the first trial, from a budget of time or a target
//! error.

use palpate_scene::Scenes;
use std::num::{NonZeroU64, NonZeroUsize};
use std::time::{Duration, Instant};

use anyhow::anyhow;
use palpate_scene::Scene;
use palpate_study::config::{self, Study};
use palpate_sweep::Cell;

use crate::cli::RunArgs;
use crate::duration::{exact, roughly, two_digits};
use crate::failure::Failure;
use crate::pace::{self, Pace};
use crate::pilot::{Need, Pilot};
use crate::rungs::{self, Allowance};
use palpate::SceneTrial;

/// Share of the target error by which the model may shift an estimate, relative to its rms error.
const SHARE_OF_MODEL: f64 = 0.1;
/// Most trials per cell that a target error may ask for.
const MOST_FOR_TARGET: f64 = 1e8;
/// Most trials per cell that a budget may give.
const MOST_FOR_BUDGET: u64 = 1_000_000_000_000;
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

/// Study whose trials and model have been chosen, with the lines and warnings to print about the choice.
pub(crate) struct Allowed {
    pub(crate) study: Study,
    pub(crate) lines: Vec<String>,
    pub(crate) warnings: Vec<String>,
}

/// Arguments of the choice: the cells that are run, the budget, the target error, the threads and the time at which
/// planning began.
struct Chooser<'a> {
    numbers: &'a [usize],
    budget: Option<Duration>,
    target: Option<f64>,
    threads: NonZeroUsize,
    start: Instant,
}

/// Chooses trials and model for `args`; `None` where they ask for no choice. The study's cells `numbers` are run.
/// `start` is when planning began.
pub(crate) fn choose(
    study: &Study,
    numbers: &[usize],
    args: &RunArgs,
    start: Instant,
) -> Result<Option<Allowed>, Failure> {
    if args.budget.is_none() && args.target_error.is_none() {
        return Ok(None);
    }
    if study.paths.iter().any(|path| path == "trials") {
        let message = "is swept, so that neither a budget nor a target error can choose it";
        return Err(Failure::usage(study.error_at(0, "trials", message)));
    }
    let chooser = Chooser {
        numbers,
        budget: args.budget,
        target: args.target_error,
        threads: pace::threads(args.threads),
        start,
    };
    chooser.choose(study).map(Some)
}

impl Chooser<'_> {
    fn choose(&self, study: &Study) -> Result<Allowed, Failure> {
        let trials = self.scenes(study)?;
        let random: Vec<usize> = (0..trials.len())
            .filter(|&place| is_random(&trials[place].scene))
            .collect();
        let pilot = self.pilot(&trials, &random)?;
        let mut warnings = match &pilot {
            Some(pilot) => self.failing(study, &trials, &random, pilot)?,
            None => Vec::new(),
        };
        let tolerance = self.target.and_then(|target| {
            let share = SHARE_OF_MODEL * target;
            let allowances = self.allowances(&trials, &random, pilot.as_ref(), share);
            rungs::tolerance_for(study, &allowances)
        });
        let tolerance = tolerance.filter(|_| rungs::is_auto(study));
        let mut config = rungs::resolved(study, self.numbers, tolerance).map_err(Failure::usage)?;

        let mut lines = Vec::new();
        let need = match (&pilot, self.target) {
            (Some(pilot), Some(target)) => Some(self.need(study, &trials, &random, pilot, target)?),
            _ => None,
        };
        let by_error = need.as_ref().map(|need| need.0);
        // The rung that the run is going to be on.
        let planned =
            config::parse("run.toml", &config::to_toml(&config)).map_err(Failure::usage)?;
        let by_time = self.fitting(&planned, &random)?;
        let chosen = match (by_error, by_time) {
            (Some(error), Some(time)) => Some(error.min(time)),
            (one, other) => one.or(other),
        };
        if random.is_empty() {
            lines.push("trials  1: no cell is random".to_owned());
        } else if let Some(trials) = chosen {
            config.trials = trials.get();
            let why = self.why(by_error, by_time, pilot.as_ref(), trials);
            lines.push(format!("trials  {trials} per random cell: {why}"));
        }
        if let Some((_, Some(need))) = need
            && need.is_doubtful
        {
            let (what, cell) = self.named(&trials, &random, &need);
            warnings.push(format!(
                "the errors of {what} in cell {cell} have heavy tails: a few trials decide their root mean square, \
                 and how well it is known is itself known roughly"
            ));
        }
        if let Some(model) = rungs::shown(&config.scene)
            && rungs::is_auto(study)
        {
            let shift = match self.target {
                Some(target) => format!(
                    ": shifts no estimate by more than {} of its rms error",
                    percent(SHARE_OF_MODEL * target)
                ),
                None => String::new(),
            };
            lines.push(format!("model   {model}{shift}"));
        }
        let study = config::parse("run.toml", &config::to_toml(&config)).map_err(Failure::usage)?;
        Ok(Allowed {
            study,
            lines,
            warnings,
        })
    }

    /// The scenes that are run; refuses where setting them up uses up the budget.
    fn scenes(&self, study: &Study) -> Result<Vec<SceneTrial>, Failure> {
        let mut scenes = Vec::with_capacity(self.numbers.len());
        for &cell in self.numbers {
            let scene = study.estimable_scene(cell).map_err(Failure::usage)?;
            scenes.push(SceneTrial::new(scene));
            if let Some(budget) = self.budget
                && self.start.elapsed() >= budget
            {
                // Planning and the run set up each cell.
                let share = scenes.len() as f64 / self.numbers.len() as f64;
                let least = 2.0 * self.start.elapsed().as_secs_f64() / share;
                return Err(self.does_not_fit(budget, least));
            }
        }
        Ok(scenes)
    }

    /// A pilot of the random cells, for the target or to tell what a budget will give; `None` where there is nothing to
    /// run, or no time.
    fn pilot(&self, trials: &[SceneTrial], random: &[usize]) -> Result<Option<Pilot>, Failure> {
        if random.is_empty() {
            return Ok(None);
        }
        let most = match self.budget {
            None => u64::MAX,
            Some(budget) => {
                let pace = self.pace(trials, budget)?;
                let each: f64 = random.iter().map(|&one| pace.seconds_per_trial(one)).sum();
                let seconds = PILOT * budget.as_secs_f64() * self.threads.get() as f64;
                ((seconds / each) as u64).min(MOST_OF_PILOT)
            }
        };
        if most < FEWEST_OF_PILOT {
            return Ok(None);
        }
        let scenes: Vec<&Scene> = random.iter().map(|&place| &trials[place].scene).collect();
        // Without a target, as many trials as the budget's share allows.
        let target = self.target.unwrap_or(f64::MIN_POSITIVE);
        let pilot = Pilot::for_error(&scenes, target, self.threads, most, MOST_FOR_TARGET);
        Ok(Some(pilot))
    }

    /// Warnings about cells of which every trial of the pilot failed, for such cells have no errors to go by. Refuses
    /// if all random cells are so and there is a target error.
    fn failing(
        &self,
        study: &Study,
        trials: &[SceneTrial],
        random: &[usize],
        pilot: &Pilot,
    ) -> Result<Vec<String>, Failure> {
        let cells = pilot.cells.iter().zip(random);
        let failing: Vec<(usize, String)> = cells
            .filter(|(cell, _)| cell.success == 0.0)
            .map(|(cell, &place)| {
                let kind = trials[place].scene.trial(0, |_, _| ()).err();
                let kind = kind.unwrap_or("not-finite");
                let failed = format!("all {} trials of a pilot fail ({kind})", cell.trials);
                (self.numbers[place], failed)
            })
            .collect();
        match (failing.first(), self.target) {
            (Some((cell, failed)), Some(target)) if failing.len() == random.len() => {
                let target = exact(target);
                let message =
                    format!("--target-error {target}: {failed}, which leaves no error to tell");
                Err(Failure::usage(study.error_at(*cell, "scene", message)))
            }
            _ => Ok(failing
                .into_iter()
                .map(|(cell, failed)| format!("{failed} in cell {cell}: it has no say"))
                .collect()),
        }
    }

    fn pace(&self, trials: &[SceneTrial], budget: Duration) -> Result<Pace, Failure> {
        let cells: Vec<Cell<'_>> = trials
            .iter()
            .map(|trial| Cell {
                trials: trial.scene.trials(MOST_FOR_BUDGET),
                trial,
            })
            .collect();
        Pace::of(&cells, self.threads, budget.mul_f64(TIMING)).map_err(Failure::work)
    }

    fn allowances(
        &self,
        trials: &[SceneTrial],
        random: &[usize],
        pilot: Option<&Pilot>,
        share: f64,
    ) -> Vec<Allowance> {
        let rms_errors = |place: usize| {
            let found = random.iter().position(|&one| one == place);
            let cell = found.and_then(|found| pilot?.cells.get(found));
            cell.map_or_else(Vec::new, |cell| {
                let figures = cell.figures.iter();
                figures
                    .map(|figure| figure.map(|figure| figure.rms_error))
                    .collect()
            })
        };
        (0..trials.len())
            .map(|place| Allowance {
                cell: self.numbers[place],
                share,
                quantities: trials[place].scene.quantities(),
                rms_errors: rms_errors(place),
            })
            .collect()
    }

    /// Number of trials that the target needs, and the figure that needs most; no figure where no estimate errs.
    fn need(
        &self,
        study: &Study,
        trials: &[SceneTrial],
        random: &[usize],
        pilot: &Pilot,
        target: f64,
    ) -> Result<(NonZeroU64, Option<Need>), Failure> {
        let Some(need) = pilot.need(target) else {
            // Where no estimate of the pilot errs, the run has as many trials as the pilot.
            let run = pilot.cells.iter().map(|cell| cell.trials).max();
            return Ok((
                NonZeroU64::new(run.unwrap_or(1)).unwrap_or(NonZeroU64::MIN),
                None,
            ));
        };
        if need.trials > MOST_FOR_TARGET && self.budget.is_none() {
            let (what, cell) = self.named(trials, random, &need);
            let tails = match need.is_doubtful {
                true => "; its errors have heavy tails",
                false => "",
            };
            let reached = target * (need.trials / MOST_FOR_TARGET).sqrt();
            let target = exact(target);
            let message = format!(
                "--target-error {target}: the rms error of {what} needs about {:.1e} trials, and at most \
                 {MOST_FOR_TARGET:.0e} are taken, which reach {reached:.1e}{tails}",
                need.trials
            );
            return Err(Failure::usage(study.error_at(cell, "trials", message)));
        }
        let trials = rounded(need.trials, f64::ceil);
        Ok((trials, Some(need)))
    }

    /// Name of the quantity that a need is about, and the number of its cell in the study.
    fn named(&self, trials: &[SceneTrial], random: &[usize], need: &Need) -> (&'static str, usize) {
        let place = random[need.cell];
        let quantity = trials[place].scene.quantities()[need.quantity];
        (quantity.name, self.numbers[place])
    }

    /// The most trials that the rest of the budget has time for; `None` without a budget.
    fn fitting(&self, planned: &Study, random: &[usize]) -> Result<Option<NonZeroU64>, Failure> {
        let Some(budget) = self.budget else {
            return Ok(None);
        };
        // The scenes are set up once more by the run.
        let before = Instant::now();
        let trials = self.scenes(planned)?;
        let setting_up = before.elapsed();
        let pace = self.pace(&trials, budget)?;
        let is_random: Vec<bool> = (0..trials.len()).map(|one| random.contains(&one)).collect();
        let planning = (self.start.elapsed() + setting_up).as_secs_f64();
        let left = KEPT * (budget.as_secs_f64() - planning);
        let most = NonZeroU64::new(MOST_FOR_BUDGET).unwrap_or(NonZeroU64::MAX);
        match pace.most_trials(&is_random, self.threads, left, most) {
            Some(trials) => Ok(Some(rounded(trials.get() as f64, f64::floor))),
            None => {
                let once = pace.run_seconds(&vec![1; trials.len()], self.threads);
                Err(self.does_not_fit(budget, planning + once / KEPT))
            }
        }
    }

    fn does_not_fit(&self, budget: Duration, least_s: f64) -> Failure {
        let budget_s = budget.as_secs_f64();
        Failure::usage(anyhow!(
            "--budget: one trial of each cell does not fit into {} s; the least is about {} on {} threads, \
             planning included",
            exact(budget_s),
            roughly(1.1 * least_s.max(budget_s)),
            self.threads
        ))
    }

    /// Reason for the number of trials: which of target and budget decides it, and the error to be expected of the
    /// figures.
    fn why(
        &self,
        by_error: Option<NonZeroU64>,
        by_time: Option<NonZeroU64>,
        pilot: Option<&Pilot>,
        trials: NonZeroU64,
    ) -> String {
        let expected = match pilot.and_then(|pilot| pilot.expected_error(trials.get())) {
            Some(error) => format!("rms errors to {} are expected", percent(error)),
            None => "how well that tells the rms errors is not known".to_owned(),
        };
        match (by_error, by_time) {
            (Some(error), Some(time)) if time < error => {
                format!("the budget rules, the target error needs {error}; {expected}")
            }
            (Some(_), Some(time)) => {
                format!("the target error rules, the budget has time for {time}; {expected}")
            }
            (Some(_), None) => format!("the target error; {expected}"),
            (None, Some(_)) if self.target.is_some() => {
                format!("the budget rules, and leaves no time for a pilot; {expected}")
            }
            (None, _) => format!("the budget; {expected}"),
        }
    }
}

fn is_random(scene: &Scene) -> bool {
    scene.trials(2) > 1
}

/// A number of trials to three digits; at least 1.
fn rounded(trials: f64, round: fn(f64) -> f64) -> NonZeroU64 {
    let unit = libm::pow(10.0, (libm::log10(trials).floor() - 2.0).max(0.0));
    let whole = round(trials / unit) * unit;
    NonZeroU64::new(whole as u64).unwrap_or(NonZeroU64::MIN)
}

/// A share to two digits.
fn percent(share: f64) -> String {
    format!("{} %", two_digits(100.0 * share))
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

    #[test]
    fn shares_have_two_digits() {
        assert_eq!(percent(0.01), "1 %");
        assert_eq!(percent(0.00123), "0.12 %");
        assert_eq!(percent(1.5), "150 %");
    }
}
