//! Rungs of EP1: how many probes roll, and how far.

use super::ladder::Ladder;
use super::trials::{Asked, Choice, relative_rms, scenes};

const PROBES: [u32; 5] = [2, 4, 8, 16, 32];
const ROLLS_RAD: [f64; 3] = [0.05, 0.2, 0.8];
const CURVATURE: usize = 0;

const COMMON: &str = r#"
kind = "roll"
probe = { kind = "sphere", radius = 10.0 }
motion = $rung
sensor = { kind = "wrist", std = 0.02 }
noise = { angular_velocity = { kind = "uniform", fraction = 0.01 } }
"#;

const SCENES: [(&str, &str); 3] = [
    (
        "ball of 10 mm",
        r#"object = { kind = "sphere", radius = 10.0 }"#,
    ),
    (
        "ball of 50 mm",
        r#"object = { kind = "sphere", radius = 50.0 }"#,
    ),
    (
        "ellipsoid of semi-axes 60, 40, 30 mm beside its top: its curvature changes on the way",
        r#"
object = { kind = "ellipsoid", semi_axes = [60.0, 40.0, 30.0] }
object_contact = [20.0, 8.0]
"#,
    ),
];

pub(super) fn ladder() -> Ladder {
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
    let asked = Asked {
        error: |scene, trials| relative_rms(scene, CURVATURE, trials),
        trials: 4000,
        timed: 256,
    };
    Ladder {
        name: "probes",
        title: "How many probes, and how far do they roll?",
        error: "rms error of the curvature over the curvature; ω errs by up to 1 %, the contact by 0.02 mm",
        evaluation: "one trial",
        scenes: scenes(COMMON, SCENES, &choices, asked),
    }
}

/// Evenly round the contact; two probes a right angle apart.
fn directions_deg(probes: u32) -> Vec<f64> {
    let turn = if probes == 2 { 180.0 } else { 360.0 };
    (0..probes)
        .map(|probe| turn * f64::from(probe) / f64::from(probes))
        .collect()
}
