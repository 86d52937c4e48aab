//! Measures the computing time of the models that can compute a scene.

use std::ops::RangeInclusive;
use std::time::Duration;

use palpate_scene::{Arch, Ladder, RollScene, Rung, Scene, SharedModels};
use palpate_study::config::{LengthUnit, SceneConfig};
use palpate_sweep::Clock;

/// Duration for which the computing time of one model is measured again and again.
const TIMING: Duration = Duration::from_millis(12);
/// Largest number of measurements of one model's computing time.
const MAX_MEASUREMENTS: usize = 100_000;
/// Largest number of trials that are timed together. With many trials, the time for reading the clock is negligible.
const MAX_TRIALS_PER_READING: u64 = 64;

/// Index in `ladder` and computing time of the chosen model, and of its neighbours: the next cheaper and the next more
/// exact model that can compute the scene, and all models between them. A time is `None` if the model cannot compute
/// the scene, or if `deadline` passed before the measurement.
pub(crate) fn neighbour_times(
    scene: (&SceneConfig, LengthUnit, u64),
    ladder: &Ladder,
    deadline: Duration,
    clock: &Clock<'_>,
) -> Vec<(usize, Option<f64>)> {
    let time = |place: usize| match clock() < deadline {
        true => evaluation_time(scene, &ladder.rungs[place], clock),
        false => None,
    };
    // Measure the chosen model first, because the times of the other models are compared with its time.
    let taken = time(ladder.taken);
    let place = |place| match place == ladder.taken {
        true => (place, taken),
        false => (place, time(place)),
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

/// Measured computing time (s) of the scene with one model: of one trial for a roll, without the time for the statistics
/// of the results, and of the set-up for a glide or a press, whose trials all have the same true values. It is the
/// shortest of several measurements, because other programs on the machine can only make a measurement longer. `None` if
/// this model cannot compute the scene.
fn evaluation_time(
    (scene, unit, seed): (&SceneConfig, LengthUnit, u64),
    rung: &Rung,
    clock: &Clock<'_>,
) -> Option<f64> {
    rung.accuracy.error()?;
    let config = scene.with_model(&rung.model)?;
    let set_up = || Scene::new(&config, unit, seed, &SharedModels::default()).ok();
    // Do not measure the first set-up, because it also fills caches and tables.
    let scene = set_up()?;
    let Scene::Roll(roll) = &scene else {
        let timed = || {
            let start = clock();
            std::hint::black_box(set_up()?);
            Some(clock().saturating_sub(start).as_secs_f64())
        };
        return least(timed, clock);
    };
    let mut trials = 1;
    let timed = || {
        let start = clock();
        run(roll, trials);
        let seconds = clock().saturating_sub(start).as_secs_f64() / trials as f64;
        trials = (2 * trials).min(MAX_TRIALS_PER_READING);
        Some(seconds)
    };
    least(timed, clock)
}

/// Runs `trials` trials in the same way as the runner: in batches, where the roll can run in batches.
fn run(roll: &RollScene, trials: u64) {
    let mut trial = 0;
    while trial < trials {
        trial += roll.side_by_side(Arch::new(), trial..trials, |observed| {
            std::hint::black_box(observed)[0].estimates.len()
        });
        if trial < trials {
            // Ignore whether a trial fails, because a failed trial takes time too.
            let _ = std::hint::black_box(roll.outcomes(trial));
            trial += 1;
        }
    }
}

/// Calls the function `measured` again and again for about [`TIMING`], but at least once. Each call measures a time.
/// Returns the shortest of these times.
fn least(mut measured: impl FnMut() -> Option<f64>, clock: &Clock<'_>) -> Option<f64> {
    let start = clock();
    let mut least = measured()?;
    for _ in 1..MAX_MEASUREMENTS {
        if clock().saturating_sub(start) >= TIMING {
            break;
        }
        least = least.min(measured()?);
    }
    Some(least)
}
