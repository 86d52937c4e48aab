//! Stated indentations of recorded presses, against what the readings say.

use palpate_press::{Body, ForwardFit, Markers, Reading, Skin};
use palpate_scene::recorded::{PressOptions, RecordedFile, estimate_press, parse_press};
use palpate_sensing::{Channel, Stream};
use palpate_study::config::{Baseline, Indentation, NoiseKnown, PressEstimatorConfig};

const RADIUS: f64 = 20.0;
const DEPTH: f64 = 2.0;
const THICKNESS: f64 = 5.0;
const INDENTATION: f64 = 1.5;
const TOLD_STD: f64 = 0.03;
const STD: f64 = 0.05;

fn estimator(is_layer: bool) -> PressEstimatorConfig {
    let (indentation, indentation_std) = (Indentation::Known, TOLD_STD);
    let (baseline, gain_std, noise) = (Baseline::Known, 0.0, NoiseKnown::Stated);
    if is_layer {
        PressEstimatorConfig::BondedLayer {
            thickness: Some(THICKNESS),
            indentation,
            indentation_std,
            baseline,
            gain_std,
            noise,
        }
    } else {
        PressEstimatorConfig::HalfSpace {
            poisson: None,
            indentation,
            indentation_std,
            baseline,
            gain_std,
            noise,
        }
    }
}

/// Shares of presses whose stated indentation is warned of where it is so many standard deviations off.
fn warned(is_layer: bool, presses: u64, offs: &[f64]) -> Vec<f64> {
    let places: Vec<[f64; 2]> = (0..49)
        .map(|marker| [marker % 7, marker / 7].map(|step| 3.0 * f64::from(step - 3)))
        .collect();
    let body = if is_layer {
        Body::bonded_layer(THICKNESS, DEPTH)
    } else {
        Body::half_space(0.5, DEPTH)
    }
    .unwrap();
    let skin = Skin::new(RADIUS).unwrap();
    let markers = Markers::new(skin, &places).unwrap();
    let contact = skin.contact(&body, 1.0 / 30.0, INDENTATION).unwrap();
    let moved = markers.displacements(&contact, [1.0, -0.5]);
    let clean: Vec<f64> = moved.iter().map(|moved| moved.normal).collect();
    let reading = |normal, indentation| Reading {
        markers: &markers,
        normal,
        tangential: None,
        indentation,
    };
    // Readings without error tell how exactly noisy ones tell the indentation.
    let stated = ForwardFit {
        normal_std: Some(STD),
        ..ForwardFit::new(body.clone())
    };
    let fitted = stated.estimate(&reading(&clean, None)).unwrap().indentation;
    let std = libm::hypot(TOLD_STD, fitted.std);
    let mut counts = vec![0; offs.len()];
    for press in 0..presses {
        let mut stream = Stream::new(17, press, Channel::NormalDisplacement);
        // The error of the stated indentation is one of the standard deviations.
        let error = TOLD_STD * stream.standard_normal();
        let mut csv = "x_mm,y_mm,normal_displacement_mm\n".to_owned();
        for ([x, y], moved) in places.iter().zip(&clean) {
            csv += &format!("{x},{y},{}\n", moved + STD * stream.standard_normal());
        }
        let readings = parse_press(RecordedFile::new("press.csv", csv.into_bytes())).unwrap();
        for (count, off) in counts.iter_mut().zip(offs) {
            let told = INDENTATION + error + off * std;
            let options = PressOptions {
                marker_depth: DEPTH,
                estimator: estimator(is_layer),
                indentation: Some(told),
                ..PressOptions::new(RADIUS)
            };
            let said = match estimate_press(&readings, &options) {
                Ok(estimate) => serde_json::to_value(estimate).unwrap()["warnings"].to_string(),
                Err(error) => error.to_string(),
            };
            *count += u32::from(said.contains("the readings alone say"));
        }
    }
    let share = |count| f64::from(count) / presses as f64;
    counts.into_iter().map(share).collect()
}

/// `few` grants shares of few presses three standard deviations.
fn holds(presses: u64, few: bool) {
    let allowance = |share: f64| {
        let std = (share * (1.0 - share) / presses as f64).sqrt();
        if few { 3.0 * std } else { 0.0 }
    };
    for is_layer in [false, true] {
        let offs = [7.0, -7.0, 5.0, -5.0, 0.5, -0.5];
        let shares = warned(is_layer, presses, &offs);
        println!("layer {is_layer}: {presses} presses, {offs:?} -> {shares:?}");
        assert_eq!(shares[..2], [1.0, 1.0]);
        assert!(
            shares[2..4]
                .iter()
                .all(|&share| share >= 0.98 - allowance(0.98))
        );
        assert!(
            shares[4..]
                .iter()
                .all(|&share| share <= 0.05 + allowance(0.05))
        );
    }
}

/// A part of what [`all_wrong_indentations_are_told`] does, in seconds.
#[test]
fn wrong_indentations_are_told() {
    holds(60, true);
}

/// All 500 presses of either body: `cargo test -p palpate-scene --test it stated -- --ignored --nocapture`.
#[test]
#[ignore = "takes a minute"]
fn all_wrong_indentations_are_told() {
    holds(500, false);
}

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
            marker_depth: DEPTH,
            estimator: PressEstimatorConfig::HalfSpace {
                poisson: None,
                indentation: Indentation::Known,
                indentation_std,
                baseline: Baseline::Known,
                gain_std: 0.0,
                noise: NoiseKnown::Stated,
            },
            indentation: Some(INDENTATION),
            ..PressOptions::new(RADIUS)
        };
        serde_json::to_value(estimate_press(&readings, &options).unwrap()).unwrap()
    };
    let (bare, stated) = (told(0.0), told(0.02 * INDENTATION));
    assert_eq!(bare["object_curvature"], stated["object_curvature"]);
    assert_eq!(stated["warnings"], serde_json::json!([]));
    let warning = bare["warnings"][0].as_str().unwrap();
    assert!(
        warning.contains("without a standard deviation: 2 % of it, 0.03 mm"),
        "{warning}"
    );
}
