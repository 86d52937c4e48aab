//! Measures how the cost of a trial grows when features (stages), such as noise or a sensor, are added to a scene. The
//! table shows that a feature costs nothing in scenes that do not use it.

use std::path::Path;
use std::time::Duration;

use anyhow::Result;

use super::ladder_tables::{count, nanoseconds};
use super::scene_trials::evaluated;
use crate::csv_table::{self, Column};
use crate::timing::Evaluation;

/// Number of trials over which the cost of a stage is averaged.
const TRIALS: u32 = 4;

/// A base scene, and the stages that are added to it one by one.
struct StagedScene {
    kind: &'static str,
    /// TOML lines of `[scene]` that all stages share, one key per line.
    base: &'static str,
    /// Name of each stage, with the config lines that the stage adds or replaces.
    stages: &'static [(&'static str, &'static str)],
}

const STAGED_SCENES: [StagedScene; 3] = [
    StagedScene {
        kind: "roll",
        base: r#"
probe = { kind = "sphere", radius = 10.0 }
object = { kind = "sphere", radius = 50.0 }
motion = { rate_rad_per_s = 0.5, duration_s = 1.0 }
"#,
        stages: &[
            ("ideal, in closed form", ""),
            (
                "noise of the angular velocity",
                r#"noise = { angular_velocity = { kind = "uniform", fraction = 0.01 } }"#,
            ),
            (
                "pads",
                r#"sensor = { kind = "pads", pitch = 0.5, offset = "random" }"#,
            ),
            (
                "encoders",
                r#"noise = { angular_velocity = { kind = "uniform", fraction = 0.01 }, encoder = { step_rad = 0.001 } }"#,
            ),
            (
                "an object on which rolls need an integrator",
                r#"object = { kind = "ellipsoid", semi_axes = [60.0, 50.0, 40.0] }"#,
            ),
            (
                "noise drawn at 100 instants",
                r#"noise = { angular_velocity = { kind = "uniform", fraction = 0.01, when = "per-instant" }, encoder = { step_rad = 0.001 } }"#,
            ),
        ],
    },
    StagedScene {
        kind: "glide",
        // These scenes measure the additional time of each feature. The estimator is the quadric, because the time of
        // its fit does not depend on the readings.
        base: r#"
probe = { kind = "point" }
object = { kind = "saddle", a = 0.1 }
motion = { finger_positions = [-1.5, 0.0, 1.5], inter_finger_distance = 1.0, patch_length = 3.0, contacts_per_finger = 10 }
evaluate = { grid = 10, half_width = 1.0, gaussian_threshold = 0.005, mean_threshold = 0.03 }
estimator = { kind = "quadric" }
"#,
        stages: &[
            ("ideal, a pointed finger", ""),
            (
                "a round tip",
                r#"probe = { kind = "sphere", radius = 0.5 }"#,
            ),
            (
                "noise of positions",
                r#"noise = { position = { kind = "gaussian", fraction_of_ifd = 0.05 } }"#,
            ),
            (
                "noise of normals",
                r#"noise = { position = { kind = "gaussian", fraction_of_ifd = 0.05 }, normal = { kind = "gaussian", std_deg = 2.0 } }"#,
            ),
            ("pads", r#"sensor = { kind = "pads", pitch = 0.05 }"#),
        ],
    },
    StagedScene {
        kind: "press",
        base: r#"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 } }
object = { kind = "sphere", radius = 80.0 }
motion = { indentation = 1.0 }
estimator = { kind = "half-space", indentation = "known" }
"#,
        stages: &[
            ("direct", ""),
            (
                "noise of displacements",
                r#"noise = { normal_displacement = { kind = "gaussian", std = 0.05 }, tangential_displacement = { kind = "gaussian", std = 0.02 } }"#,
            ),
            (
                "a bonded layer",
                r#"
model = { kind = "bonded-layer", thickness = 5.0 }
estimator = { kind = "bonded-layer", indentation = "known" }
"#,
            ),
            (
                "a camera, without pixels",
                r#"
sensor = { kind = "projected" }
noise = { hue = { kind = "gaussian", std = 1e-4 }, centroid = { kind = "gaussian", std = 0.01 }, size = { kind = "gaussian", std = 4e-4 } }
"#,
            ),
            (
                "rendered frames, 265 px",
                r#"
sensor = { kind = "rendered", size_px = 265, calibration = { presses = 2, rest_frames = 1 } }
noise = {}
"#,
            ),
            (
                "noise of pixels",
                r#"noise = { pixel = { kind = "gaussian", std = 2.0 } }"#,
            ),
        ],
    },
];

pub(super) struct Stage {
    kind: &'static str,
    name: &'static str,
    text: String,
}

pub(super) fn stages() -> Vec<Stage> {
    let key = |line: &str| line.split(" = ").next().map(str::to_owned);
    let mut all = Vec::new();
    for &StagedScene { kind, base, stages } in &STAGED_SCENES {
        let mut lines: Vec<&str> = base.lines().collect();
        for &(name, changes) in stages {
            for change in changes.lines() {
                lines.retain(|line| key(line) != key(change));
                lines.push(change);
            }
            let text = format!("kind = \"{kind}\"\n{}", lines.join("\n"));
            all.push(Stage { kind, name, text });
        }
    }
    all
}

impl Stage {
    /// The computation whose cost is measured: trials of the scene with this stage and all stages before it.
    pub(super) fn evaluation(&self) -> Evaluation {
        Evaluation::new(self.name, evaluated(self.text.clone(), TRIALS)).evaluations_per_run(TRIALS)
    }
}

/// Measures the times of the stages and writes `stages.csv` to a folder.
pub(super) fn write(
    stages: &[Stage],
    instructions: Option<&[u64]>,
    patience: Duration,
    folder: &Path,
) -> Result<()> {
    let row = |(at, stage): (usize, &Stage)| -> Vec<Column> {
        let [kind, name] = [stage.kind, stage.name].map(str::to_owned);
        let names = [("scene", kind), ("stage", name)].into_iter();
        let cost = nanoseconds(&stage.evaluation().time(patience));
        let instructions = count(instructions.map(|counts| counts[at]));
        names.chain(cost).chain([instructions]).collect()
    };
    csv_table::write(
        &folder.join("stages.csv"),
        stages.iter().enumerate().map(row),
    )
}
