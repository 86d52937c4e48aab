//! Trials of a scene, in the form that the runner of sweeps uses.

use std::ops::Range;

use palpate_sweep::{Record, Trial};

use crate::roll::Arch;
use crate::scene::Scene;

/// A scene whose trials the runner of sweeps can run.
#[derive(Debug)]
pub struct SceneTrial {
    /// The scene whose trials are run.
    pub scene: Scene,
    /// Vector instructions that run batches of trials. The results do not depend on them.
    pub arch: Arch,
}

impl SceneTrial {
    /// The trials of a scene. Batches of trials run with the widest vector instructions of the processor.
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
        self.scene
            .trial(trial, |quantity, one| record.observe(quantity, one))
    }

    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        match &self.scene {
            Scene::Roll(roll) => roll.side_by_side(self.arch, trials, |observed| {
                record.observe_together(observed)
            }),
            _ => 0,
        }
    }

    fn is_random(&self) -> bool {
        self.scene.is_random()
    }
}
