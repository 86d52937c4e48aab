//! Cost of each stage of a scene: a scene costs only what its stages need.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result};
use palpate_statistics::work::Tally;
#[cfg(feature = "count")]
use palpate_statistics::work::counted;

use super::ladder_tables::{count, nanoseconds};
use super::scene_trials::evaluated;
#[cfg(feature = "count")]
use super::scene_trials::{run, scene_of};
use crate::csv_table::{self, Column};
use crate::timing::Evaluation;

/// Number of trials for the mean cost.
const TRIALS: u32 = 4;

/// A base scene and its stages.
struct StagedScene {
    kind: &'static str,
    /// Common TOML of `[scene]`, one key per line.
    base: &'static str,
    /// Names of the stages, with the keys that each adds or replaces.
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
                "an object that needs an integrator",
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
        // The estimator is the quadric, because its cost does not depend on the readings.
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

/// A scene with all stages up to one.
pub(super) struct Stage {
    kind: &'static str,
    name: &'static str,
    text: String,
}

/// All stages, in order.
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
    /// Trials of the stage.
    pub(super) fn evaluation(&self) -> Evaluation {
        Evaluation::new(self.name, evaluated(self.text.clone(), TRIALS)).evaluations_per_run(TRIALS)
    }

    /// Columns that name the stage.
    fn names(&self) -> Vec<Column> {
        let [kind, name] = [self.kind, self.name].map(str::to_owned);
        vec![("scene", kind), ("stage", name)]
    }

    /// Work of one trial, after a first trial has set up everything that is set up only once.
    #[cfg(feature = "count")]
    fn tally(&self) -> Result<Tally> {
        let scene = scene_of(&self.text)?;
        run(&scene, 1);
        Ok(counted(|| run(&scene, 1)).0)
    }
}

/// Name of a column, and the function that returns its count from a trial's tally.
type Counter = (&'static str, fn(&Tally) -> u64);
/// Columns of the work counts.
const WORK_COLUMNS: [Counter; 6] = [
    ("random_draws", |tally| tally.draws),
    ("integrator_derivatives", |tally| tally.derivatives),
    ("contact_searches", |tally| tally.searches),
    ("layer_solves", |tally| tally.layers),
    ("projected_markers", |tally| tally.projections),
    ("rendered_frames", |tally| tally.frames),
];

/// Writes the work of a trial of each stage, in their order.
#[cfg(feature = "count")]
pub(super) fn write_work_counts(path: &Path) -> Result<()> {
    let row = |stage: &Stage| -> Result<Vec<Column>> {
        let tally = stage.tally()?;
        let counts = WORK_COLUMNS.map(|(name, count)| (name, count(&tally).to_string()));
        Ok([stage.names(), counts.into()].concat())
    };
    let rows: Vec<Vec<Column>> = stages().iter().map(row).collect::<Result<_>>()?;
    csv_table::write(path, rows)
}

/// Reads the rows of [`write_work_counts`].
pub(super) fn read_work_counts(path: &Path) -> Result<Vec<csv::StringRecord>> {
    let rows = csv::Reader::from_path(path).and_then(|reader| reader.into_records().collect());
    rows.with_context(|| format!("cannot read {}", path.display()))
}

/// Times the stages and writes `stages.csv` to a folder.
pub(super) fn write(
    stages: &[Stage],
    instructions: Option<&[u64]>,
    work_counts: &[csv::StringRecord],
    patience: Duration,
    folder: &Path,
) -> Result<()> {
    let row = |(at, stage): (usize, &Stage)| -> Result<Vec<Column>> {
        let names = stage.names();
        let is_named =
            |row: &&csv::StringRecord| names.iter().map(|(_, name)| name).eq(row.iter().take(2));
        let row = work_counts.iter().find(is_named);
        let row =
            row.with_context(|| format!("{}: no work counts of {}", stage.kind, stage.name))?;
        let counts = row.iter().skip(2).map(str::to_owned);
        let counts = WORK_COLUMNS.iter().map(|(name, _)| *name).zip(counts);
        let cost = nanoseconds(&stage.evaluation().time(patience));
        let instructions = count(instructions.map(|counts| counts[at]));
        Ok(names
            .iter()
            .cloned()
            .chain(cost)
            .chain([instructions])
            .chain(counts)
            .collect())
    };
    let rows: Vec<Vec<Column>> = stages.iter().enumerate().map(row).collect::<Result<_>>()?;
    csv_table::write(&folder.join("stages.csv"), rows)
}

#[cfg(feature = "count")]
#[cfg(test)]
mod tests {
    use super::*;

    fn tally(kind: &str, name: &str) -> Tally {
        let stages = stages();
        let stage = stages
            .iter()
            .find(|stage| stage.kind == kind && stage.name == name);
        stage.unwrap().tally().unwrap()
    }

    #[test]
    fn a_scene_does_only_the_work_of_its_stages() {
        assert_eq!(tally("roll", "ideal, in closed form"), Tally::default());
        assert_eq!(tally("press", "direct"), Tally::default());
        assert_eq!(tally("glide", "ideal, a pointed finger"), Tally::default());
        let noisy = tally("roll", "noise of the angular velocity");
        assert!(noisy.draws > 0 && noisy.derivatives == 0, "{noisy:?}");
        let integrated = tally("roll", "an object that needs an integrator");
        assert!(integrated.derivatives > 0, "{integrated:?}");
        let projected = tally("press", "a camera, without pixels");
        assert!(
            projected.projections > 0 && projected.frames == 0,
            "{projected:?}"
        );
    }
}
