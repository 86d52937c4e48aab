//! The ladder of a cell in words: the rung that is taken, and what its neighbours would cost and err.

use palpate_scene::Scenes;
use std::time::{Duration, Instant};

use palpate_scene::{Ladder, RollScene, Rung, Scene};
use palpate_study::config::{ModelConfig, PressSensorConfig, RollModelConfig, SceneConfig, Study};

use crate::duration;
use palpate::{Arch, SceneTrial};

/// Time for which a rung is measured again and again.
const TIMING: Duration = Duration::from_millis(12);
/// Most trials of a roll between two readings of the clock; enough to make the cost of reading it negligible.
const MOST_AT_ONCE: u64 = 64;

/// Cost of a rung, s. It is the least of several measurements, because whatever else the machine does only adds to
/// them.
enum Cost {
    /// Seconds per trial, without the statistics: each trial of a roll follows its contacts anew.
    EachTrial(f64),
    /// Seconds to set up the scene: contacts of a glide and displacements of markers are computed once for all trials.
    SettingUp(f64),
}

/// Words for the quantity whose errors are shown and the scale that they are relative to.
pub(crate) fn error_of(ladder: &Ladder) -> &'static str {
    match ladder.taken().model {
        ModelConfig::Roll(_) => {
            "places of the contacts at the end, relative to the first contact's length scale"
        }
        ModelConfig::Glide(_) => "places of contacts, relative to the tip's radius",
        ModelConfig::Press(_) => "displacements of markers, relative to the largest",
    }
}

/// Lines that show the rung taken for a cell with the reason, and the next usable rungs below and above it. Costs are
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

/// Range of indices from the next usable rung below the taken one to the next usable rung above it.
fn neighbours(ladder: &Ladder) -> std::ops::RangeInclusive<usize> {
    let can = |place: &usize| ladder.rungs[*place].outcome.is_ok();
    let last = ladder.rungs.len() - 1;
    let down = (0..ladder.taken).rev().find(can).unwrap_or(0);
    let up = (ladder.taken + 1..=last).find(can).unwrap_or(last);
    down..=up
}

/// Measured cost of the scene on a rung; `None` where the rung cannot do the scene, or `deadline` has passed.
fn cost(study: &Study, cell: usize, rung: &Rung, deadline: Instant) -> Option<Cost> {
    if rung.outcome.is_err() || Instant::now() >= deadline {
        return None;
    }
    // Once to fill caches and tables.
    let scene = study.with_model(cell, rung).ok()?;
    let Scene::Roll(roll) = &scene else {
        let timed = || {
            let start = Instant::now();
            std::hint::black_box(study.with_model(cell, rung).ok()?);
            Some(start.elapsed().as_secs_f64())
        };
        return least(timed).map(Cost::SettingUp);
    };
    let mut trials = 1;
    let timed = || {
        let start = Instant::now();
        run(roll, trials);
        let seconds = start.elapsed().as_secs_f64() / trials as f64;
        trials = (2 * trials).min(MOST_AT_ONCE);
        Some(seconds)
    };
    least(timed).map(Cost::EachTrial)
}

/// Runs trials 0 to `trials` as the runner does, side by side where the roll can.
fn run(roll: &RollScene, trials: u64) {
    let mut trial = 0;
    while trial < trials {
        trial += roll.side_by_side(Arch::new(), trial..trials, |observed| {
            std::hint::black_box(observed);
            true
        });
        if trial < trials {
            // A trial that fails takes its time, too.
            let _ = std::hint::black_box(roll.outcomes(trial));
            trial += 1;
        }
    }
}

/// Least of the values measured within about [`TIMING`]; at least one is taken.
fn least(mut measured: impl FnMut() -> Option<f64>) -> Option<f64> {
    let start = Instant::now();
    let mut least = measured()?;
    while start.elapsed() < TIMING {
        least = least.min(measured()?);
    }
    Some(least)
}

impl Cost {
    fn seconds(&self) -> f64 {
        let (Self::EachTrial(seconds) | Self::SettingUp(seconds)) = self;
        *seconds
    }

    fn told(&self) -> String {
        let seconds = duration::short(self.seconds());
        match self {
            Self::EachTrial(_) => format!(", {seconds} per trial"),
            Self::SettingUp(_) => format!(", {seconds} once for all trials"),
        }
    }

    /// Words for the cost, with its ratio to that of the rung that is taken.
    fn beside(&self, taken: Option<&Self>) -> String {
        let ratio = taken.map(|taken| {
            let ratio = self.seconds() / taken.seconds();
            format!(" ({} x)", duration::two_digits(ratio))
        });
        self.told() + &ratio.unwrap_or_default()
    }
}

/// Line that names the means which scenes of this kind may need and this one does not; `None` where it needs all of
/// them.
pub(crate) fn not_needed(
    trial: &SceneTrial,
    scene: &SceneConfig,
    taken: Option<&ModelConfig>,
) -> Option<String> {
    let is_random = trial.scene.trials(2) > 1;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_of_several_counts() {
        let mut samples = [3.0, 1.0, 2.0].into_iter().chain(std::iter::repeat(4.0));
        assert_eq!(least(|| samples.next()), Some(1.0));
    }

    #[test]
    fn what_takes_long_is_measured_once() {
        let mut times = 0;
        let slow = || {
            std::thread::sleep(TIMING);
            times += 1;
            Some(1.0)
        };
        assert_eq!((least(slow), times), (Some(1.0), 1));
        assert_eq!(least(|| None), None);
    }
}
