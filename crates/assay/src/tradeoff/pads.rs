//! Rungs of a pad array: its pitch and its layout.

use super::ladder::Ladder;
use super::trials::{Asked, Choice, relative_rms, scenes};

const PITCHES_MM: [f64; 8] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.1, 0.05, 0.02];
const CURVATURE: usize = 0;

const COMMON: &str = r#"
kind = "roll"
probe = { kind = "sphere", radius = 10.0 }
motion = { rate_rad_per_s = 0.5, duration_s = 1.0 }
sensor = $rung
"#;

const SCENES: [(&str, &str); 3] = [
    (
        "ball of 11 mm",
        r#"object = { kind = "sphere", radius = 11.0 }"#,
    ),
    (
        "ball of 50 mm",
        r#"object = { kind = "sphere", radius = 50.0 }"#,
    ),
    (
        "ball of 500 mm",
        r#"object = { kind = "sphere", radius = 500.0 }"#,
    ),
];

pub(super) fn ladder() -> Ladder {
    let layouts = ["square", "uniform"];
    let choices: Vec<Choice> = layouts
        .iter()
        .flat_map(|layout| {
            PITCHES_MM.map(|pitch| {
                let text = format!(
                    r#"{{ kind = "pads", pitch = {pitch}, layout = "{layout}", offset = "random" }}"#
                );
                Choice::new(format!("{layout} {pitch} mm"), text).set(pitch)
            })
        })
        .collect();
    let asked = Asked {
        error: |scene, trials| relative_rms(scene, CURVATURE, trials),
        trials: 2000,
        timed: 256,
    };
    Ladder {
        name: "pads",
        title: "What do finer pads cost?",
        error: "rms error of the curvature over the curvature; 8 probes of 10 mm roll 0.5 rad, pads anywhere",
        evaluation: "one trial",
        scenes: scenes(COMMON, SCENES, &choices, asked),
    }
}
