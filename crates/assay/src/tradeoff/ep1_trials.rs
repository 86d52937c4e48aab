//! Ladders (lists of compared settings) for estimates from rolls (EP1). One ladder compares pad arrays; the other
//! compares the number and the length of the rolls.

use super::ladder::Ladder;
use super::scene_trials::{Choice, Measure, relative_rms, scenes};

/// Index, among the quantities of a roll, of the curvature whose error is measured.
const CURVATURE: usize = 0;

const PITCHES_MM: [f64; 8] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.1, 0.05, 0.02];
const PAD_COMMON: &str = r#"
kind = "roll"
probe = { kind = "sphere", radius = 10.0 }
motion = { rate_rad_per_s = 0.5, duration_s = 1.0 }
sensor = $rung
"#;

const PAD_SCENES: [(&str, &str); 3] = [
    (
        "ball of radius 11 mm",
        r#"object = { kind = "sphere", radius = 11.0 }"#,
    ),
    (
        "ball of radius 50 mm",
        r#"object = { kind = "sphere", radius = 50.0 }"#,
    ),
    (
        "ball of radius 500 mm",
        r#"object = { kind = "sphere", radius = 500.0 }"#,
    ),
];

/// The ladder (list of compared settings) of pad arrays, which differ in the pitch and the layout of the pads.
pub(super) fn pads() -> Ladder {
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
    let measure = Measure {
        error: |scene, trials| relative_rms(scene, CURVATURE, trials),
        trials: 2000,
        timed: 256,
    };
    Ladder {
        name: "pads",
        title: "What do finer pads cost?",
        error: "rms error of the curvature over the curvature; 8 probes of 10 mm roll 0.5 rad, pads anywhere",
        evaluation: "one trial",
        scenes: scenes(PAD_COMMON, PAD_SCENES, &choices, measure),
    }
}

const PROBES: [u32; 5] = [2, 4, 8, 16, 32];
const ROLLS_RAD: [f64; 3] = [0.05, 0.2, 0.8];

const PROBE_COMMON: &str = r#"
kind = "roll"
probe = { kind = "sphere", radius = 10.0 }
motion = $rung
sensor = { kind = "wrist", std = 0.02 }
noise = { angular_velocity = { kind = "uniform", fraction = 0.01 } }
"#;

const PROBE_SCENES: [(&str, &str); 3] = [
    (
        "ball of radius 10 mm",
        r#"object = { kind = "sphere", radius = 10.0 }"#,
    ),
    (
        "ball of radius 50 mm",
        r#"object = { kind = "sphere", radius = 50.0 }"#,
    ),
    (
        "ellipsoid with the semi-axes 60, 40, 30 mm, beside its top: the curvature changes along the roll",
        r#"
object = { kind = "ellipsoid", semi_axes = [60.0, 40.0, 30.0] }
object_contact = [20.0, 8.0]
"#,
    ),
];

/// The ladder (list of compared settings) of estimates from rolls (EP1). The settings differ in the number of probes
/// and the length of their rolls.
pub(super) fn probes() -> Ladder {
    let choices: Vec<Choice> = ROLLS_RAD
        .iter()
        .flat_map(|&angle| {
            PROBES.map(|probes| {
                let text = format!(
                    "{{ rate_rad_per_s = 1.0, duration_s = {angle:?}, directions_deg = {:?} }}",
                    directions_deg(probes)
                );
                Choice::new(format!("{probes} × {angle} rad"), text).set(f64::from(probes))
            })
        })
        .collect();
    let measure = Measure {
        error: |scene, trials| relative_rms(scene, CURVATURE, trials),
        trials: 4000,
        timed: 256,
    };
    Ladder {
        name: "probes",
        title: "How many probes, and how far do they roll?",
        error: "rms error of the curvature over the curvature; ω errs by up to 1 %, the contact by 0.02 mm",
        evaluation: "one trial",
        scenes: scenes(PROBE_COMMON, PROBE_SCENES, &choices, measure),
    }
}

/// Roll directions at equal angles, one for each probe. For two probes, the directions are at a right angle.
fn directions_deg(probes: u32) -> Vec<f64> {
    let turn = if probes == 2 { 180.0 } else { 360.0 };
    (0..probes)
        .map(|probe| turn * f64::from(probe) / f64::from(probes))
        .collect()
}
