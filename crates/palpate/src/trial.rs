//! A scene as something to repeat.

use palpate_scene::Scene;
use palpate_sweep::{Observation, Record, Trial};

/// Repeats a scene.
pub(crate) struct SceneTrial(pub(crate) Scene);

impl Trial for SceneTrial {
    fn quantities(&self) -> usize {
        self.0.quantities().len()
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        self.0.trial(trial, |quantity, outcome| {
            let palpate_scene::Outcome {
                estimate,
                truth,
                std,
            } = outcome;
            record.observe(
                quantity,
                Observation {
                    estimate,
                    truth,
                    std,
                },
            );
        })
    }
}
