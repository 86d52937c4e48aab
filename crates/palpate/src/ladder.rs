//! The ladder of a cell in words: the rung that is taken, and what its neighbours would cost and err.

use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

use palpate_scene::config::{ModelConfig, PressSensorConfig, RollModelConfig, SceneConfig, Study};
use palpate_scene::{Ladder, Rung, Scene};
use palpate_sweep::Cell;

use crate::duration;
use crate::pace::Pace;
use crate::trial::SceneTrial;

/// How long the trials of a rung are timed.
const TIMING: Duration = Duration::from_millis(10);

/// What a rung costs.
struct Cost {
    /// Each trial of a roll follows its contacts.
    trial_s: Option<f64>,
    /// Contacts of a glide and markers of a press are computed once.
    setting_up_s: f64,
}

/// The rung of a cell, why it is taken, and the next ones up and down; nothing of a scene that has no ladder. Costs are
/// measured until `deadline`.
pub(crate) fn lines(study: &Study, cell: usize, ladder: &Ladder, deadline: Instant) -> Vec<String> {
    let shown = neighbours(ladder);
    let names = shown
        .clone()
        .map(|place| ladder.rungs[place].name.chars().count());
    let width = names.max().unwrap_or(0);
    let chosen = match ladder.tolerance {
        Some(tolerance) => format!("chosen for a tolerance of {tolerance:e}: "),
        None => String::new(),
    };
    let mut lines = vec![format!("{chosen}{}", ladder.reason)];
    let of_taken = cost(study, cell, ladder.taken(), deadline);
    for place in shown {
        let rung = &ladder.rungs[place];
        let mark = if place == ladder.taken { '>' } else { ' ' };
        let cost = match place == ladder.taken {
            true => of_taken.as_ref().map(Cost::told),
            false => cost(study, cell, rung, deadline).map(|cost| cost.beside(of_taken.as_ref())),
        };
        let said = match &rung.outcome {
            Err(why) => format!("cannot: {why}"),
            Ok(_) if ladder.reference == Some(place) => {
                format!("what errors are held against{}", cost.unwrap_or_default())
            }
            Ok(error) => format!("error {error:.1e}{}", cost.unwrap_or_default()),
        };
        lines.push(format!("{mark} {:width$}  {said}", rung.name));
    }
    lines
}

/// The taken rung's place and those up and down from it, as far as the next one that can do the scene.
fn neighbours(ladder: &Ladder) -> std::ops::RangeInclusive<usize> {
    let can = |place: &usize| ladder.rungs[*place].outcome.is_ok();
    let last = ladder.rungs.len() - 1;
    let down = (0..ladder.taken).rev().find(can).unwrap_or(0);
    let up = (ladder.taken + 1..=last).find(can).unwrap_or(last);
    down..=up
}

/// What the scene costs on a rung; `None` where that cannot do it, or there is no time left.
fn cost(study: &Study, cell: usize, rung: &Rung, deadline: Instant) -> Option<Cost> {
    if rung.outcome.is_err() || Instant::now() >= deadline {
        return None;
    }
    // Once to fill caches and tables.
    study.with_model(cell, rung).ok()?;
    let start = Instant::now();
    let trial = SceneTrial(study.with_model(cell, rung).ok()?);
    let setting_up_s = start.elapsed().as_secs_f64();
    if !matches!(trial.0, Scene::Roll(_)) {
        return Some(Cost {
            trial_s: None,
            setting_up_s,
        });
    }
    let timed = Cell {
        trials: u64::MAX,
        trial: &trial,
    };
    let pace = Pace::of(&[timed], NonZeroUsize::MIN, TIMING).ok()?;
    Some(Cost {
        trial_s: Some(pace.seconds_per_trial(0)),
        setting_up_s,
    })
}

impl Cost {
    fn told(&self) -> String {
        let setting_up = duration::short(self.setting_up_s);
        match self.trial_s {
            Some(trial) => format!(", {} per trial", duration::short(trial)),
            None => format!(", {setting_up} once for all trials"),
        }
    }

    /// With the ratio to the rung that is taken.
    fn beside(&self, taken: Option<&Self>) -> String {
        let seconds = |cost: &Self| cost.trial_s.unwrap_or(cost.setting_up_s);
        let ratio = taken.map(|taken| {
            format!(
                " ({} x)",
                duration::two_digits(seconds(self) / seconds(taken))
            )
        });
        self.told() + &ratio.unwrap_or_default()
    }
}

/// What a scene of this kind may need and this one does not, on one line.
pub(crate) fn not_needed(
    trial: &SceneTrial,
    scene: &SceneConfig,
    taken: Option<&ModelConfig>,
) -> Option<String> {
    let is_random = trial.0.trials(2) > 1;
    let integrates = !matches!(
        taken,
        Some(ModelConfig::Roll(
            RollModelConfig::ClosedForm {} | RollModelConfig::Meridian {}
        ))
    );
    let renders = match scene {
        SceneConfig::Press(press) => matches!(press.sensor, PressSensorConfig::Rendered(_)),
        _ => true,
    };
    let needless: Vec<&str> = [
        (is_random, "random numbers"),
        (integrates, "integrator"),
        (renders, "frames"),
    ]
    .into_iter()
    .filter_map(|(needs, what)| (!needs).then_some(what))
    .collect();
    (!needless.is_empty()).then(|| format!("needs no {}", needless.join(", no ")))
}
