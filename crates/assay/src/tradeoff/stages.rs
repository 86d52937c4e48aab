//! Cost that each stage adds to a scene: a scene pays only for the stages it names.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use palpate_tally::Tally;
#[cfg(feature = "count")]
use palpate_tally::counted;

use super::table::{count, nanoseconds, table};
use super::trials::evaluated;
#[cfg(feature = "count")]
use super::trials::{run, scene_of};
use crate::measured::Evaluation;

/// Trials in a row whose mean cost is stated.
const TRIALS: u32 = 4;

/// Scene with its stages; each stage adds keys of `[scene]` or replaces their values.
struct Staged {
    kind: &'static str,
    /// Keys and values of the first stage.
    base: &'static [(&'static str, &'static str)],
    stages: &'static [(&'static str, &'static [(&'static str, &'static str)])],
}

const NONE: &[(&str, &str)] = &[];

const STAGED: [Staged; 3] = [
    Staged {
        kind: "roll",
        base: &[
            ("probe", r#"{ kind = "sphere", radius = 10.0 }"#),
            ("object", r#"{ kind = "sphere", radius = 50.0 }"#),
            ("motion", "{ rate_rad_per_s = 0.5, duration_s = 1.0 }"),
        ],
        stages: &[
            ("ideal, in closed form", NONE),
            (
                "noise of the angular velocity",
                &[(
                    "noise",
                    r#"{ angular_velocity = { kind = "uniform", fraction = 0.01 } }"#,
                )],
            ),
            (
                "pads",
                &[(
                    "sensor",
                    r#"{ kind = "pads", pitch = 0.5, offset = "random" }"#,
                )],
            ),
            (
                "encoders",
                &[(
                    "noise",
                    r#"{ angular_velocity = { kind = "uniform", fraction = 0.01 }, encoder = { step_rad = 0.001 } }"#,
                )],
            ),
            (
                "an object that needs an integrator",
                &[(
                    "object",
                    r#"{ kind = "ellipsoid", semi_axes = [60.0, 50.0, 40.0] }"#,
                )],
            ),
            (
                "noise drawn at 100 instants",
                &[(
                    "noise",
                    r#"{ angular_velocity = { kind = "uniform", fraction = 0.01, when = "per-instant" }, encoder = { step_rad = 0.001 } }"#,
                )],
            ),
        ],
    },
    Staged {
        kind: "glide",
        base: &[
            ("probe", r#"{ kind = "point" }"#),
            ("object", r#"{ kind = "saddle", a = 0.1 }"#),
            (
                "motion",
                "{ finger_positions = [-1.5, 0.0, 1.5], inter_finger_distance = 1.0, patch_length = 3.0, contacts_per_finger = 10 }",
            ),
            (
                "evaluate",
                "{ grid = 10, half_width = 1.0, gaussian_threshold = 0.005, mean_threshold = 0.03 }",
            ),
            // The cost of the quadric does not depend on its data.
            ("estimator", r#"{ kind = "quadric" }"#),
        ],
        stages: &[
            ("ideal, a pointed finger", NONE),
            (
                "a round tip",
                &[("probe", r#"{ kind = "sphere", radius = 0.5 }"#)],
            ),
            (
                "noise of positions",
                &[(
                    "noise",
                    r#"{ position = { kind = "gaussian", fraction_of_ifd = 0.05 } }"#,
                )],
            ),
            (
                "noise of normals",
                &[(
                    "noise",
                    r#"{ position = { kind = "gaussian", fraction_of_ifd = 0.05 }, normal = { kind = "gaussian", std_deg = 2.0 } }"#,
                )],
            ),
            ("pads", &[("sensor", r#"{ kind = "pads", pitch = 0.05 }"#)]),
        ],
    },
    Staged {
        kind: "press",
        base: &[
            (
                "probe",
                r#"{ kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 } }"#,
            ),
            ("object", r#"{ kind = "sphere", radius = 80.0 }"#),
            ("motion", "{ indentation = 1.0 }"),
            (
                "estimator",
                r#"{ kind = "half-space", indentation = "known" }"#,
            ),
        ],
        stages: &[
            ("direct", NONE),
            (
                "noise of displacements",
                &[(
                    "noise",
                    r#"{ normal_displacement = { kind = "gaussian", std = 0.05 }, tangential_displacement = { kind = "gaussian", std = 0.02 } }"#,
                )],
            ),
            (
                "a bonded layer",
                &[
                    ("model", r#"{ kind = "bonded-layer", thickness = 5.0 }"#),
                    (
                        "estimator",
                        r#"{ kind = "bonded-layer", indentation = "known" }"#,
                    ),
                ],
            ),
            (
                "a camera, without pixels",
                &[
                    ("sensor", r#"{ kind = "projected" }"#),
                    (
                        "noise",
                        r#"{ hue = { kind = "gaussian", std = 1e-4 }, centroid = { kind = "gaussian", std = 0.01 }, size = { kind = "gaussian", std = 4e-4 } }"#,
                    ),
                ],
            ),
            (
                "rendered frames, 265 px",
                &[
                    (
                        "sensor",
                        r#"{ kind = "rendered", size_px = 265, calibration = { presses = 2, rest_frames = 1 } }"#,
                    ),
                    ("noise", "{}"),
                ],
            ),
            (
                "noise of pixels",
                &[("noise", r#"{ pixel = { kind = "gaussian", std = 2.0 } }"#)],
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
    let mut all = Vec::new();
    for staged in &STAGED {
        let mut keys: Vec<(&str, &str)> = staged.base.to_vec();
        for (name, changes) in staged.stages {
            for &(key, value) in *changes {
                keys.retain(|(known, _)| *known != key);
                keys.push((key, value));
            }
            let lines = keys.iter().map(|(key, value)| format!("{key} = {value}\n"));
            all.push(Stage {
                kind: staged.kind,
                name,
                text: format!("kind = \"{}\"\n{}", staged.kind, lines.collect::<String>()),
            });
        }
    }
    all
}

impl Stage {
    /// Its trials.
    pub(super) fn evaluation(&self) -> Evaluation {
        Evaluation::new(self.name, evaluated(self.text.clone(), TRIALS)).in_a_row(TRIALS)
    }

    /// Work that one trial does, after a first trial has made everything that is made only once.
    #[cfg(feature = "count")]
    fn tally(&self) -> Result<Tally> {
        let scene = scene_of(&self.text)?;
        run(&scene, 1);
        Ok(counted(|| run(&scene, 1)).0)
    }
}

/// Columns that name the stage of a row.
const STAGE: [&str; 2] = ["scene", "stage"];
/// Columns of the cost of a trial.
const TIMED: [&str; 4] = ["median_ns", "q25_ns", "q75_ns", "instructions"];
/// Name of a column, and the count that stands in it.
type Counter = (&'static str, fn(&Tally) -> u64);
/// Columns of the work that a trial does.
const TALLIED: [Counter; 6] = [
    ("random_draws", |tally| tally.draws),
    ("integrator_derivatives", |tally| tally.derivatives),
    ("contact_searches", |tally| tally.searches),
    ("layer_solves", |tally| tally.layers),
    ("projected_markers", |tally| tally.projections),
    ("rendered_frames", |tally| tally.frames),
];

/// The columns of tallies.
fn tallied() -> Vec<&'static str> {
    let names = TALLIED.map(|(name, _)| name);
    [&STAGE[..], &names].concat()
}

/// Work that a trial of one stage does, as read from a table.
pub(super) struct Tallied {
    stage: [String; 2],
    counts: [String; 6],
}

/// Writes what a trial of each stage does, in their order.
#[cfg(feature = "count")]
pub(super) fn write_tallies(path: &Path) -> Result<()> {
    let row = |stage: Stage| -> Result<Vec<String>> {
        let tally = stage.tally()?;
        let counts = TALLIED.map(|(_, count)| count(&tally).to_string());
        let stage = [stage.kind, stage.name].map(str::to_owned);
        Ok([&stage[..], &counts].concat())
    };
    let rows: Vec<Vec<String>> = stages().into_iter().map(row).collect::<Result<_>>()?;
    table(path, &tallied(), rows.into_iter())
}

/// Reads the table that [`write_tallies`] has written.
pub(super) fn read_tallies(path: &Path) -> Result<Vec<Tallied>> {
    let cannot = || format!("cannot read {}", path.display());
    let mut reader = csv::Reader::from_path(path).with_context(cannot)?;
    ensure!(
        reader.headers().with_context(cannot)? == tallied(),
        "{} holds no tallies",
        path.display()
    );
    let row = |record: Result<csv::StringRecord, csv::Error>| -> Result<Tallied> {
        let record = record.with_context(cannot)?;
        Ok(Tallied {
            stage: std::array::from_fn(|column| record[column].to_owned()),
            counts: std::array::from_fn(|column| record[STAGE.len() + column].to_owned()),
        })
    };
    reader.records().map(row).collect()
}

/// Times the stages and writes `stages.csv` to a folder.
pub(super) fn write(
    stages: &[Stage],
    instructions: Option<&[u64]>,
    tallies: &[Tallied],
    patience: Duration,
    folder: &Path,
) -> Result<()> {
    let row = |(at, stage): (usize, &Stage)| -> Result<Vec<String>> {
        let Tallied {
            stage: names,
            counts,
        } = tallies
            .iter()
            .find(|tallied| tallied.stage == [stage.kind, stage.name])
            .with_context(|| format!("{}: {} is not tallied", stage.kind, stage.name))?;
        let times = nanoseconds(&stage.evaluation().time(patience));
        let instructions = count(instructions.map(|counts| counts[at]));
        Ok([&names[..], &times, &[instructions], counts].concat())
    };
    let rows: Vec<Vec<String>> = stages.iter().enumerate().map(row).collect::<Result<_>>()?;
    let (stage, counts) = (&STAGE[..], TALLIED.map(|(name, _)| name));
    let header = [stage, &TIMED, &counts].concat();
    table(&folder.join("stages.csv"), &header, rows.into_iter())
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
    fn a_scene_does_only_what_its_stages_ask_for() {
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
