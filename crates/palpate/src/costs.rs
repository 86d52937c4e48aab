//! Costs of the rungs of a cell's ladder, measured.

use std::ops::RangeInclusive;
use std::time::Duration;

use palpate_scene::{Arch, Ladder, RollScene, Rung, Scene};
use palpate_study::config::SceneConfig;
use palpate_sweep::Clock;

/// Time for which a rung is measured again and again.
const TIMING: Duration = Duration::from_millis(12);
/// Most measurements of a rung.
const MOST_MEASURED: usize = 100_000;
/// Most trials of a roll between two readings of the clock; enough to make the cost of reading it negligible.
const MOST_AT_ONCE: u64 = 64;

/// Cost of a rung, s. It is the least of several measurements, because whatever else the machine does only adds to
/// them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cost {
    /// Seconds per trial, without the statistics: each trial of a roll follows its contacts anew.
    EachTrial(f64),
    /// Seconds to set up the scene: contacts of a glide and displacements of markers are computed once for all trials.
    SettingUp(f64),
}

impl Cost {
    /// Seconds, per trial or once.
    pub fn seconds(&self) -> f64 {
        let (Self::EachTrial(seconds) | Self::SettingUp(seconds)) = self;
        *seconds
    }
}

/// Rungs of a scene's ladder from the next usable one below that which is taken to the next usable one above it, with their
/// costs as far as they are measured until `deadline`.
pub(crate) fn of_neighbours(
    (scene, seed): (&SceneConfig, u64),
    ladder: &Ladder,
    deadline: Duration,
    clock: &Clock<'_>,
) -> Vec<(usize, Option<Cost>)> {
    let cost = |place: usize| match clock() < deadline {
        true => cost(scene, seed, &ladder.rungs[place], clock),
        false => None,
    };
    // First the one that others are held against.
    let taken = cost(ladder.taken);
    let place = |place| match place == ladder.taken {
        true => (place, taken),
        false => (place, cost(place)),
    };
    neighbours(ladder).map(place).collect()
}

fn neighbours(ladder: &Ladder) -> RangeInclusive<usize> {
    let can = |place: &usize| ladder.rungs[*place].accuracy.error().is_some();
    let last = ladder.rungs.len() - 1;
    let down = (0..ladder.taken).rev().find(can).unwrap_or(0);
    let up = (ladder.taken + 1..=last).find(can).unwrap_or(last);
    down..=up
}

/// Measured cost of the scene on a rung; `None` where the rung cannot do the scene.
fn cost(scene: &SceneConfig, seed: u64, rung: &Rung, clock: &Clock<'_>) -> Option<Cost> {
    rung.accuracy.error()?;
    let config = scene.with_model(&rung.model)?;
    let set_up = || Scene::new(&config, seed).ok();
    // Once to fill caches and tables.
    let scene = set_up()?;
    let Scene::Roll(roll) = &scene else {
        let timed = || {
            let start = clock();
            std::hint::black_box(set_up()?);
            Some(clock().saturating_sub(start).as_secs_f64())
        };
        return least(timed, clock).map(Cost::SettingUp);
    };
    let mut trials = 1;
    let timed = || {
        let start = clock();
        run(roll, trials);
        let seconds = clock().saturating_sub(start).as_secs_f64() / trials as f64;
        trials = (2 * trials).min(MOST_AT_ONCE);
        Some(seconds)
    };
    least(timed, clock).map(Cost::EachTrial)
}

/// Runs trials 0 to `trials` as the runner does, side by side where the roll can.
fn run(roll: &RollScene, trials: u64) {
    let mut trial = 0;
    while trial < trials {
        trial += roll.side_by_side(Arch::new(), trial..trials, |observed| {
            std::hint::black_box(observed)[0].estimates.len()
        });
        if trial < trials {
            // A trial that fails takes its time, too.
            let _ = std::hint::black_box(roll.outcomes(trial));
            trial += 1;
        }
    }
}

/// Least of the values measured within about [`TIMING`]; at least one is taken.
fn least(mut measured: impl FnMut() -> Option<f64>, clock: &Clock<'_>) -> Option<f64> {
    let start = clock();
    let mut least = measured()?;
    for _ in 1..MOST_MEASURED {
        if clock().saturating_sub(start) >= TIMING {
            break;
        }
        least = least.min(measured()?);
    }
    Some(least)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn the_least_of_several_counts() {
        // A clock that goes on by 1 ms whenever it is read.
        let now = Cell::new(Duration::ZERO);
        let clock = || now.replace(now.get() + Duration::from_millis(1));
        let mut samples = [3.0, 1.0, 2.0].into_iter().chain(std::iter::repeat(4.0));
        assert_eq!(least(|| samples.next(), &clock), Some(1.0));
        assert_eq!(least(|| None, &clock), None);
    }

    #[test]
    fn what_takes_long_is_measured_once() {
        let now = Cell::new(Duration::ZERO);
        let mut times = 0;
        let slow = || {
            now.set(now.get() + TIMING);
            times += 1;
            Some(1.0)
        };
        assert_eq!((least(slow, &|| now.get()), times), (Some(1.0), 1));
    }

    #[test]
    fn a_clock_that_stands_still_ends_too() {
        assert_eq!(least(|| Some(1.0), &|| Duration::ZERO), Some(1.0));
    }
}
