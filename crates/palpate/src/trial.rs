//! A scene as something to repeat.

use std::ops::Range;

use palpate_scene::{Outcome, RollScene, Scene};
use palpate_sweep::{Observation, Observations, Record, Trial};

/// Repeats a scene.
pub(crate) struct SceneTrial(pub(crate) Scene);

impl Trial for SceneTrial {
    fn quantities(&self) -> usize {
        self.0.quantities().len()
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        match &self.0 {
            Scene::Roll(roll) => record.observe_each(roll.outcomes(trial)?.map(observation)),
            Scene::Glide(glide) => glide.trial(trial, |quantity, outcome| {
                record.observe(quantity, observation(outcome));
            })?,
            Scene::Press(press) => press.trial(trial, |quantity, outcome| {
                record.observe(quantity, observation(outcome));
            })?,
            Scene::Fingertip(fingertip) => fingertip.trial(|quantity, outcome| {
                record.observe(quantity, observation(outcome));
            })?,
        }
        Ok(())
    }

    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        match &self.0 {
            Scene::Roll(roll) => roll_together(roll, trials, record),
            Scene::Glide(_) | Scene::Press(_) | Scene::Fingertip(_) => 0,
        }
    }
}

/// Runs the first of `trials` side by side, as far as that goes.
fn roll_together(roll: &RollScene, trials: Range<u64>, record: &mut Record) -> u64 {
    const LANES: u64 = RollScene::SIDE_BY_SIDE as u64;
    let mut trial = trials.start;
    while trials.end - trial >= LANES
        && let Some(outcomes) = roll.side_by_side(std::array::from_fn(|lane| trial + lane as u64))
        && record.observe_together(&outcomes.map(|(estimates, truth, stds)| Observations {
            estimates,
            truth,
            stds,
        }))
    {
        trial += LANES;
    }
    trial - trials.start
}

fn observation(outcome: Outcome) -> Observation {
    let Outcome {
        estimate,
        truth,
        std,
        interval_holds,
    } = outcome;
    Observation {
        estimate,
        truth,
        std,
        interval_holds,
    }
}
