//! A scene as something to repeat.

use palpate_scene::{Outcome, Scene};
use palpate_sweep::{Observation, Record, Trial};

/// Repeats a scene.
pub(crate) struct SceneTrial(pub(crate) Scene);

impl Trial for SceneTrial {
    fn quantities(&self) -> usize {
        self.0.quantities().len()
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        match &self.0 {
            Scene::Roll(roll) => record.observe_each(roll.outcomes(trial)?.map(observation)),
        }
        Ok(())
    }
}

fn observation(outcome: Outcome) -> Observation {
    let Outcome {
        estimate,
        truth,
        std,
    } = outcome;
    Observation {
        estimate,
        truth,
        std,
    }
}
