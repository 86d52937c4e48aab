//! Rungs of a press sensor: displacements, markers as a camera shows them without pixels, frames.
//!
//! Each has a noise of its own, which its name does not tell but the ladder's error does: they are no measure of one
//! camera by another.

use super::ladder::Ladder;
use super::trials::{Asked, Choice, relative_rms, scenes};

const EFFECTIVE_RADIUS: usize = 1;
const SIZES_PX: [u32; 3] = [265, 640, 1024];

const COMMON: &str = r#"
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 } }
model = { kind = "bonded-layer", thickness = 5.0 }
$rung
estimator = { kind = "bonded-layer", indentation = "known" }
"#;

const SCENES: [(&str, &str); 3] = [
    (
        "ball of 40 mm, 1 mm deep",
        r#"
object = { kind = "sphere", radius = 40.0 }
motion = { indentation = 1.0 }
"#,
    ),
    (
        "plane, 1.4 mm deep",
        r#"
object = { kind = "plane" }
motion = { indentation = 1.4 }
"#,
    ),
    (
        "dish of 80 mm, 0.3 mm deep, calibrated to 1.4 mm",
        r#"
object = { kind = "dish", radius = 80.0 }
motion = { indentation = 0.3 }
"#,
    ),
];

/// Name, and noise of what the rung reads.
const WITHOUT_PIXELS: [(&str, &str); 2] = [
    (
        "direct",
        r#"normal_displacement = { kind = "gaussian", std = 0.005 }, tangential_displacement = { kind = "gaussian", std = 0.001 }"#,
    ),
    (
        "projected",
        r#"hue = { kind = "gaussian", std = 1e-4 }, centroid = { kind = "gaussian", std = 0.01 }, size = { kind = "gaussian", std = 4e-4 }"#,
    ),
];
const OF_PIXELS: &str = r#"pixel = { kind = "gaussian", std = 2.0 }"#;
const CALIBRATION: &str = "calibration = { indentation = 1.4 }";
/// Calibration with few presses for scenes of which only the cost is measured: it is sooner made, and a press costs the
/// same.
const SHORT_CALIBRATION: &str = "calibration = { indentation = 1.4, presses = 2, rest_frames = 1 }";

pub(super) fn ladder() -> Ladder {
    let mut choices: Vec<Choice> = WITHOUT_PIXELS
        .iter()
        .map(|&(kind, noise)| {
            let camera = match kind {
                "direct" => String::new(),
                _ => format!(", {CALIBRATION}"),
            };
            let text = format!("sensor = {{ kind = \"{kind}\"{camera} }}\nnoise = {{ {noise} }}");
            Choice::new(kind, text)
        })
        .collect();
    choices.extend(SIZES_PX.map(|size| {
        let text = |calibration| {
            format!(
                "sensor = {{ kind = \"rendered\", size_px = {size}, {calibration} }}\nnoise = {{ {OF_PIXELS} }}"
            )
        };
        Choice {
            evaluated: Some(text(SHORT_CALIBRATION)),
            ..Choice::new(format!("rendered {size} px"), text(CALIBRATION)).set(f64::from(size))
        }
    }));
    let asked = Asked {
        error: |scene, trials| relative_rms(scene, EFFECTIVE_RADIUS, trials),
        trials: 16,
        timed: 1,
    };
    Ladder {
        name: "press-sensors",
        title: "What does a camera in the sensor cost?",
        error: "rms error of the effective radius over it; direct reads within 0.005 mm and 0.001 mm along the skin, projected within 1e-4 of hue, 0.01 px and 4e-4 of size, pixels within 2/255, each the standard deviation",
        evaluation: "one press: what is read, and the estimate",
        scenes: scenes(COMMON, SCENES, &choices, asked),
    }
}
