//! A scene as something to repeat.

use std::ops::Range;

use palpate_scene::{Arch, Outcome, Scene, SideBySide};
use palpate_sweep::{Observation, Observations, Record, Trial};

/// Repeats a scene.
#[derive(Debug)]
pub struct SceneTrial {
    /// The scene.
    pub scene: Scene,
    /// Instructions for trials side by side; no number depends on them.
    pub arch: Arch,
}

impl SceneTrial {
    /// Trials of a scene, side by side with the widest vectors that the processor has.
    pub fn new(scene: Scene) -> Self {
        Self {
            scene,
            arch: Arch::new(),
        }
    }
}

impl Trial for SceneTrial {
    fn quantities(&self) -> usize {
        self.scene.quantities().len()
    }

    fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
        self.scene.trial(trial, |quantity, outcome| {
            record.observe(quantity, observation(outcome));
        })
    }

    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        match &self.scene {
            Scene::Roll(roll) => roll.side_by_side(self.arch, trials, |observed| {
                record.observe_together(&observed.map(observations))
            }),
            _ => 0,
        }
    }

    fn is_random(&self) -> bool {
        self.scene.is_random()
    }
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

fn observations(side_by_side: SideBySide<'_>) -> Observations<'_> {
    let SideBySide {
        estimates,
        truth,
        stds,
    } = side_by_side;
    Observations {
        estimates,
        truth,
        stds,
    }
}
