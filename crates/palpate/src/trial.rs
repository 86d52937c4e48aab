//! Trials of a scene, and the trace of one pass.

use std::ops::Range;

use palpate_scene::{Arch, Scene, Scenes, Trace, TraceError as PassError};
use palpate_study::config::{ConfigError, Study};
use palpate_sweep::{Observation, Observations, Record, Trial};
use thiserror::Error;

/// Scene whose trials the runner repeats.
#[derive(Debug)]
pub struct SceneTrial {
    /// The scene.
    pub scene: Scene,
    /// Vector instructions for trials side by side. No result depends on them.
    pub arch: Arch,
}

impl SceneTrial {
    /// Trials of a scene, with the widest vectors of the processor.
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
            let observation = Observation {
                estimate: outcome.estimate,
                truth: outcome.truth,
                std: outcome.std,
                interval_holds: outcome.interval_holds,
            };
            record.observe(quantity, observation);
        })
    }

    fn run_together(&self, trials: Range<u64>, record: &mut Record) -> u64 {
        match &self.scene {
            Scene::Roll(roll) => roll.side_by_side(self.arch, trials, |observed| {
                record.observe_together(&observed.map(|one| Observations {
                    estimates: one.estimates,
                    truth: one.truth,
                    stds: one.stds,
                }))
            }),
            _ => 0,
        }
    }

    fn is_random(&self) -> bool {
        self.scene.is_random()
    }
}

/// Reason why a pass cannot be traced.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TraceError {
    /// Invalid field, scene without contact, or a number that is not a cell of the study.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Pass that ends early, or that the sensor cannot read.
    #[error(transparent)]
    Pass(PassError),
}

/// Traces one pass of a cell: without noise, or as in trial number `trial`.
///
/// ```
/// let text = r#"
/// name = "a-ball"
/// length_unit = "mm"
/// [scene]
/// kind = "roll"
/// probe = { kind = "sphere", radius = 10.0 }
/// object = { kind = "sphere", radius = 30.0 }
/// motion = { rate_rad_per_s = 0.1, duration_s = 1.0, directions_deg = [0.0, 90.0] }
/// "#;
/// let study = palpate::parse("a-ball.toml", text)?;
/// let trace = palpate::trace(&study, 0, None)?;
/// assert_eq!(trace.what, "202 contacts of 2 probes");
/// assert!(palpate::trace(&study, 1, None).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`TraceError`].
pub fn trace(study: &Study, cell: usize, trial: Option<u64>) -> Result<Trace, TraceError> {
    let unit = study.config.length_unit;
    let trace = study.scene(cell)?.trace(trial, unit);
    trace.map_err(|error| match error {
        PassError::Untouched => study.error_at(0, "scene.kind", error.to_string()).into(),
        error => TraceError::Pass(error),
    })
}
