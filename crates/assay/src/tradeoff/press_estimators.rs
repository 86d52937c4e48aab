//! Rungs of the press estimators.

use super::ladder::{Ease, Ladder};
use super::trials::{Asked, Choice, Template, relative_rms};

const EFFECTIVE_RADIUS: usize = 1;

const COMMON: &str = r#"
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0 }
motion = { indentation = 1.0 }
noise = { normal_displacement = { kind = "gaussian", std = 0.05 }, tangential_displacement = { kind = "gaussian", std = 0.02 }, indentation = { kind = "gaussian", std = 0.02 } }
estimator = $rung
"#;

const SCENES: [(&str, &str); 3] = [
    (
        "half-space on a ball of 80 mm",
        r#"
object = { kind = "sphere", radius = 80.0 }
model = { kind = "half-space" }
"#,
    ),
    (
        "layer of 10 mm on a plane",
        r#"
object = { kind = "plane" }
model = { kind = "bonded-layer", thickness = 10.0 }
"#,
    ),
    (
        "layer of 5 mm in a dish of 80 mm",
        r#"
object = { kind = "dish", radius = 80.0 }
model = { kind = "bonded-layer", thickness = 5.0 }
"#,
    ),
];

/// Name, kind and what else it is told.
const ESTIMATORS: [(&str, &str, &str); 3] = [
    ("Gaussian", "gaussian", ""),
    ("half-space", "half-space", ""),
    ("layer", "bonded-layer", ", thickness = $layer"),
];

pub(super) fn ladder() -> Ladder {
    let asked = Asked {
        error: |scene, trials| relative_rms(scene, EFFECTIVE_RADIUS, trials),
        trials: 200,
        timed: 4,
    };
    let stage = |scene: &Template| scene.stage(&choices(scene.ease), asked);
    Ladder {
        name: "press-estimators",
        title: "Which estimator of a press?",
        error: "rms error of the effective radius over it; noise 0.05 mm, 0.02 mm along the skin and of δ",
        evaluation: "one trial: readings and estimate",
        scenes: Template::all(COMMON, SCENES).iter().map(stage).collect(),
    }
}

fn choices(ease: Ease) -> Vec<Choice> {
    // What is no layer is one as thick as the sensor is wide.
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
