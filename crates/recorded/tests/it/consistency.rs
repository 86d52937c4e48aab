//! Stated indentations of recorded presses.

use palpate_recorded::{PressOptions, RecordedFile, estimate_press, parse_press};
use palpate_study::config::{
    DisplacementPriors, Indentation, IndentationPrior, PressEstimatorConfig,
};

const RADIUS: f64 = 20.0;
const DEPTH: f64 = 2.0;
const INDENTATION: f64 = 1.5;

/// An indentation is never exact: without a standard deviation it has a share of itself.
#[test]
fn a_bare_indentation_has_a_standard_deviation() {
    let readings = std::fs::read(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/press-readings.csv"
    ))
    .unwrap();
    let readings = parse_press(RecordedFile::new("press.csv", readings)).unwrap();
    let told = |indentation_std: f64| {
        let options = PressOptions {
            marker_depth: Some(DEPTH),
            estimator: PressEstimatorConfig::HalfSpace {
                poisson: None,
                prior: IndentationPrior {
                    indentation: Indentation::Known,
                    indentation_std,
                },
                displacements: DisplacementPriors::default(),
            },
            indentation: Some(INDENTATION),
            ..PressOptions::new(RADIUS)
        };
        serde_json::to_value(estimate_press(&readings, &options).unwrap()).unwrap()
    };
    let (bare, stated) = (told(0.0), told(0.02 * INDENTATION));
    assert_eq!(bare["object_curvature"], stated["object_curvature"]);
    assert_eq!(stated["warnings"], serde_json::json!([]));
    let warning = bare["warnings"][0]["text"].as_str().unwrap();
    assert!(
        warning.contains("without a standard deviation: 2 % of it, 0.03 mm"),
        "{warning}"
    );
}
