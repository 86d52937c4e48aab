//! The ladders (lists of compared settings) of press sensors and of press estimators.

use super::ladder::{Ease, Ladder};
use super::scene_trials::{Choice, Measure, Template, relative_rms, scenes};

/// Index, among the quantities of a press, of the effective radius, whose error is measured.
const EFFECTIVE_RADIUS: usize = 1;
/// Sizes of the square rendered frames: the number of pixels along one side.
const SIZES_PX: [u32; 3] = [265, 640, 1024];

const SENSOR_COMMON: &str = r#"
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 } }
model = { kind = "bonded-layer", thickness = 5.0 }
$rung
estimator = { kind = "bonded-layer", indentation = "known" }
"#;

const SENSOR_SCENES: [(&str, &str); 3] = [
    (
        "ball of radius 40 mm, pressed 1 mm deep",
        r#"
object = { kind = "sphere", radius = 40.0 }
motion = { indentation = 1.0 }
"#,
    ),
    (
        "plane, pressed 1.4 mm deep",
        r#"
object = { kind = "plane" }
motion = { indentation = 1.4 }
"#,
    ),
    (
        "dish of radius 80 mm, pressed 0.3 mm deep; sensor calibrated up to 1.4 mm deep",
        r#"
object = { kind = "dish", radius = 80.0 }
motion = { indentation = 0.3 }
"#,
    ),
];

/// Name and noise of each sensor that is simulated without rendered frames.
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
const PIXEL_NOISE: &str = r#"pixel = { kind = "gaussian", std = 2.0 }"#;
const CALIBRATION: &str = "calibration = { indentation = 1.4 }";
/// Calibration that replaces `CALIBRATION` while the time is measured. It has few presses, so the set-up is faster. A
/// simulated press costs the same with both calibrations.
const SHORT_CALIBRATION: &str = "calibration = { indentation = 1.4, presses = 2, rest_frames = 1 }";

/// The ladder (list of compared settings) of press sensors. Some sensors measure displacements directly, some project
/// markers, and some render frames. Each kind has its own noise, so the errors do not show which real camera is more
/// accurate. The ladder's description of the error states the noise.
pub(super) fn sensors() -> Ladder {
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
                "sensor = {{ kind = \"rendered\", size_px = {size}, {calibration} }}\nnoise = {{ {PIXEL_NOISE} }}"
            )
        };
        Choice {
            evaluated: Some(text(SHORT_CALIBRATION)),
            ..Choice::new(format!("rendered {size} px"), text(CALIBRATION)).set(f64::from(size))
        }
    }));
    let measure = Measure {
        error: |scene, trials| relative_rms(scene, EFFECTIVE_RADIUS, trials),
        trials: 16,
        timed: 1,
    };
    Ladder {
        name: "press-sensors",
        title: "What does a camera in the sensor cost?",
        error: "rms error of the effective radius over it; direct reads within 0.005 mm and 0.001 mm along the skin, projected within 1e-4 of hue, 0.01 px and 4e-4 of size, pixels within 2/255, each the standard deviation",
        evaluation: "one press: readings and estimate",
        scenes: scenes(SENSOR_COMMON, SENSOR_SCENES, &choices, measure),
    }
}

const ESTIMATOR_COMMON: &str = r#"
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }
motion = { indentation = 1.0 }
noise = { normal_displacement = { kind = "gaussian", std = 0.05 }, tangential_displacement = { kind = "gaussian", std = 0.02 }, indentation = { kind = "gaussian", std = 0.02 } }
estimator = $rung
"#;

const ESTIMATOR_SCENES: [(&str, &str); 3] = [
    (
        "probe that is a half-space, pressed onto a ball of radius 80 mm",
        r#"
object = { kind = "sphere", radius = 80.0 }
model = { kind = "half-space" }
"#,
    ),
    (
        "probe with a layer of thickness 10 mm, pressed onto a plane",
        r#"
object = { kind = "plane" }
model = { kind = "bonded-layer", thickness = 10.0 }
"#,
    ),
    (
        "probe with a layer of thickness 5 mm, pressed into a dish of radius 80 mm",
        r#"
object = { kind = "dish", radius = 80.0 }
model = { kind = "bonded-layer", thickness = 5.0 }
"#,
    ),
];

/// Compared estimators: name, kind in the config, and further settings.
const ESTIMATORS: [(&str, &str, &str); 3] = [
    ("Gaussian", "gaussian", ""),
    ("half-space", "half-space", ""),
    ("layer", "bonded-layer", ", thickness = $layer"),
];

pub(super) fn estimators() -> Ladder {
    let measure = Measure {
        error: |scene, trials| relative_rms(scene, EFFECTIVE_RADIUS, trials),
        trials: 200,
        timed: 4,
    };
    let stage = |scene: &Template| scene.stage(&estimator_choices(scene.ease), measure);
    Ladder {
        name: "press-estimators",
        title: "Which estimator for a press?",
        error: "rms error of the effective radius over it; noise 0.05 mm, 0.02 mm along the skin and of δ",
        evaluation: "one trial: readings and estimate",
        scenes: Template::all(ESTIMATOR_COMMON, ESTIMATOR_SCENES)
            .iter()
            .map(stage)
            .collect(),
    }
}

fn estimator_choices(ease: Ease) -> Vec<Choice> {
    // In the easy scene, the layer is as thick as the sensor's radius. So the model of a half-space is nearly right.
    let thickness = match ease {
        Ease::Easy => "20.0",
        Ease::Typical => "10.0",
        Ease::Hard => "5.0",
    };
    let indentations = [
        ("", r#"indentation = "known", indentation_std = 0.02"#),
        (", δ fitted", r#"indentation = "fitted""#),
    ];
    ESTIMATORS
        .iter()
        .flat_map(|(name, kind, more)| {
            indentations.map(|(suffix, indentation)| {
                let more = more.replace("$layer", thickness);
                let text = format!(r#"{{ kind = "{kind}", {indentation}{more} }}"#);
                Choice::new(format!("{name}{suffix}"), text)
            })
        })
        .collect()
}
