//! Rungs of a press sensor: displacements as they are, markers as a camera shows them, frames.

use anyhow::Context;

use super::ladder::{Ease, Ladder};
use super::trials::{Asked, Choice, Template, relative_rms};

const EFFECTIVE_RADIUS: usize = 1;
const SIZES_PX: [u32; 3] = [265, 640, 1024];

const SCENES: [Template; 3] = [
    Template {
        ease: Ease::Easy,
        scene: "ball of 40 mm, 1 mm deep",
        text: r#"
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 } }
object = { kind = "sphere", radius = 40.0 }
motion = { indentation = 1.0 }
model = { kind = "bonded-layer", thickness = 5.0 }
sensor = $rung
estimator = { kind = "bonded-layer", indentation = "known" }
"#,
    },
    Template {
        ease: Ease::Typical,
        scene: "plane, 1.4 mm deep",
        text: r#"
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 } }
object = { kind = "plane" }
motion = { indentation = 1.4 }
model = { kind = "bonded-layer", thickness = 5.0 }
sensor = $rung
estimator = { kind = "bonded-layer", indentation = "known" }
"#,
    },
    Template {
        ease: Ease::Hard,
        scene: "dish of 80 mm, 0.3 mm deep, calibrated to 1.4 mm",
        text: r#"
kind = "press"
probe = { kind = "marker-sphere", radius = 20.0, marker_depth = 2.0, discs = { magenta_diameter = 2.0, yellow_diameter = 2.0, separation = 2.0 } }
object = { kind = "dish", radius = 80.0 }
motion = { indentation = 0.3 }
model = { kind = "bonded-layer", thickness = 5.0 }
sensor = $rung
estimator = { kind = "bonded-layer", indentation = "known" }
"#,
    },
];

pub(super) fn ladder() -> Ladder {
    let camera = |kind: &str| format!(r#"kind = "{kind}", calibration = {{ indentation = 1.4 }}"#);
    let mut choices = vec![
        Choice::new("direct", r#"{ kind = "direct" }"#),
        Choice::new("projected", format!("{{ {} }}", camera("projected"))),
    ];
    choices.extend(SIZES_PX.map(|size| {
        let text = format!("{{ {}, size_px = {size} }}", camera("rendered"));
        Choice::new(format!("rendered {size} px"), text).set(f64::from(size))
    }));
    let asked = Asked {
        error: |scene, _| relative_rms(scene, EFFECTIVE_RADIUS, 1).context("one press"),
        trials: 1,
        timed: 1,
    };
    Ladder {
        name: "press-sensors",
        title: "What does a camera in the sensor cost?",
        error: "error of the effective radius over it, without noise",
        evaluation: "one press: what is read, and the estimate",
        scenes: SCENES
            .iter()
            .map(|scene| scene.stage(&choices, asked))
            .collect(),
    }
}
