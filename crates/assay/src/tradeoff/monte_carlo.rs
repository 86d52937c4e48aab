//! Ladder of a Monte-Carlo study: the number of trials.

use anyhow::{Context, Result};
use palpate_scene::Scene;

use super::ladder::{Ladder, RungError};
use super::scene_trials::{Choice, Measure, Template, at_least_rounding, outcomes, root_mean};

/// Index of the quantity whose rms error counts: the first that a scene estimates.
const QUANTITY: usize = 0;

const SCENES: [(&str, &str); 3] = [
    (
        "rolls on a ball",
        r#"
kind = "roll"
probe = { kind = "sphere", radius = 1.0 }
object = { kind = "sphere", radius = 5.0 }
motion = { rate_rad_per_s = 0.1, duration_s = 1.0 }
noise = { angular_velocity = { kind = "uniform", fraction = 0.01 } }
"#,
    ),
    (
        "presses of a half-space on a ball",
        r#"
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }
object = { kind = "sphere", radius = 80.0 }
motion = { indentation = 1.0 }
noise = { normal_displacement = { kind = "gaussian", std = 0.05 }, indentation = { kind = "gaussian", std = 0.02 } }
estimator = { kind = "half-space", indentation = "known", indentation_std = 0.02 }
"#,
    ),
    (
        "glides over a saddle, in its middle",
        r#"
kind = "glide"
probe = { kind = "point" }
object = { kind = "saddle", a = 0.1 }
motion = { finger_positions = [-1.5, 0.0, 1.5], inter_finger_distance = 1.0, patch_length = 3.0, contacts_per_finger = 10 }
noise = { position = { kind = "gaussian", fraction_of_ifd = 0.05 }, normal = { kind = "gaussian", std_deg = 2.0 } }
evaluate = { grid = 1, half_width = 1.0, gaussian_threshold = 0.005, mean_threshold = 0.03 }
"#,
    ),
];

/// Numbers of trials of each scene.
const TRIALS: [&[u32]; 3] = [
    &[10, 100, 1000, 10_000, 100_000],
    &[10, 30, 100],
    &[10, 30, 100],
];

pub(super) fn ladder() -> Ladder {
    let stage = |(scene, trials): (Template, &[u32])| {
        let mut stage = scene.stage(&[], measure(1));
        for &trials in trials {
            let choice = Choice::new(format!("{trials} trials"), "").set(f64::from(trials));
            let one = scene.stage(&[choice], measure(trials));
            // One evaluation consists of all trials.
            stage.rungs.extend(
                one.rungs
                    .into_iter()
                    .map(|rung| rung.evaluations_per_run(1)),
            );
        }
        stage
    };
    Ladder {
        name: "monte-carlo",
        title: "How many trials?",
        error: "standard error of the rms error that a study states, over it",
        evaluation: "all trials",
        scenes: Template::all("", SCENES)
            .into_iter()
            .zip(TRIALS)
            .map(stage)
            .collect(),
    }
}

fn measure(trials: u32) -> Measure {
    Measure {
        error: standard_error,
        trials: u64::from(trials),
        timed: trials,
    }
}

/// Standard error of the rms error, relative to it.
fn standard_error(scene: &Scene, trials: u64) -> Result<RungError> {
    let squares: Vec<f64> = outcomes(scene, trials)?
        .into_iter()
        .flatten()
        .filter(|(quantity, _)| *quantity == QUANTITY)
        .map(|(_, outcome)| (outcome.estimate - outcome.truth).powi(2))
        .collect();
    let rms = root_mean(&squares)?;
    let std = rms.std.context("a single trial has no scatter")?;
    at_least_rounding(std / rms.error).map(RungError::from)
}
