//! Stated indentations of recorded presses, against what the readings say.

use palpate_press::{Body, ForwardFit, Markers, Reading, Skin};
use palpate_recorded::{PressOptions, RecordedFile, estimate_press, parse_press};
use palpate_sensing::{Channel, Stream};
use palpate_study::config::{Baseline, Indentation, NoiseKnown, PressEstimatorConfig};

const RADIUS: f64 = 20.0;
const DEPTH: f64 = 2.0;
const THICKNESS: f64 = 5.0;
const INDENTATION: f64 = 1.5;
const TOLD_STD: f64 = 0.03;

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

/// A sensor with markers, pressed on an object.
struct Case {
    is_layer: bool,
    places: Vec<[f64; 2]>,
    clean: Vec<f64>,
    /// Standard deviation of each displacement, and whether it is stated.
    std: f64,
    is_stated: bool,
    /// Number of markers that are wrong by 1 mm.
    wrong: usize,
    /// Standard deviation of a stated indentation minus the fitted one.
    apart_std: f64,
}

impl Case {
    fn new(is_layer: bool, object: f64, std: f64, is_stated: bool, wrong: usize) -> Self {
        let body = if is_layer {
            Body::bonded_layer(THICKNESS, DEPTH)
        } else {
            Body::half_space(0.5, DEPTH)
        };
        let body = body.unwrap();
        let places: Vec<[f64; 2]> = (0..49)
            .map(|marker| [marker % 7, marker / 7].map(|step| 3.0 * f64::from(step - 3)))
            .collect();
        let skin = Skin::new(RADIUS).unwrap();
        let markers = Markers::new(skin, &places).unwrap();
        let contact = skin.contact(&body, object, INDENTATION).unwrap();
        let moved = markers.displacements(&contact, [1.0, -0.5]);
        let clean: Vec<f64> = moved.iter().map(|moved| moved.normal).collect();
        // Readings without error tell how exactly noisy ones tell the indentation.
        let stated = ForwardFit {
            normal_std: Some(std),
            ..ForwardFit::new(body.clone())
        };
        let fitted = stated.estimate(&Reading {
            markers: &markers,
            normal: &clean,
            tangential: None,
            indentation: None,
        });
        Self {
            is_layer,
            apart_std: libm::hypot(TOLD_STD, fitted.unwrap().indentation.std),
            places,
            clean,
            std,
            is_stated,
            wrong,
        }
    }

    fn all() -> Vec<Self> {
        let mut cases = Vec::new();
        for is_layer in [false, true] {
            for object in [1.0 / 12.0, 1.0 / 30.0, 1.0 / 80.0, 0.0, -1.0 / 60.0] {
                for std in [0.02, 0.05, 0.08] {
                    for is_stated in [true, false] {
                        for wrong in [0, 2] {
                            cases.push(Self::new(is_layer, object, std, is_stated, wrong));
                        }
                    }
                }
            }
        }
        cases
    }

    /// A press whose indentation is stated so many standard deviations off, as a table, and what is stated.
    fn press(&self, press: u64, off: f64) -> (String, f64) {
        let mut stream = Stream::new(17, press, Channel::NormalDisplacement);
        // The error of the stated indentation is one of the standard deviations.
        let told = INDENTATION + TOLD_STD * stream.standard_normal() + off * self.apart_std;
        let mut normal: Vec<f64> = self.clean.clone();
        for moved in &mut normal {
            *moved += self.std * stream.standard_normal();
        }
        for wrong in 0..self.wrong {
            let marker = press as usize * 7 + 23 * wrong;
            normal[marker % self.clean.len()] += 1.0;
        }
        let mut csv = "x_mm,y_mm,normal_displacement_mm\n".to_owned();
        for ([x, y], normal) in self.places.iter().zip(normal) {
            csv += &format!("{x},{y},{normal}\n");
        }
        (csv, told)
    }

    fn is_warned(&self, press: u64, off: f64) -> bool {
        let (csv, told) = self.press(press, off);
        let readings = parse_press(RecordedFile::new("press.csv", csv.into_bytes())).unwrap();
        let options = PressOptions {
            marker_depth: Some(DEPTH),
            estimator: estimator(self.is_layer),
            indentation: Some(told),
            normal_std: self.is_stated.then_some(self.std),
            ..PressOptions::new(RADIUS)
        };
        let said = match estimate_press(&readings, &options) {
            Ok(estimate) => serde_json::to_value(estimate).unwrap()["warnings"].to_string(),
            Err(error) => error.to_string(),
        };
        said.contains("the readings alone say")
    }
}

/// Number of presses with a warning, one press for every `step`-th case. The stated indentation of each press is
/// `off` standard deviations too large or too small.
fn warned(off: f64, step: usize) -> usize {
    let cases = Case::all();
    let is_warned = |press: &usize| {
        let sign = if (press / 7).is_multiple_of(2) {
            1.0
        } else {
            -1.0
        };
        cases[*press].is_warned(*press as u64, sign * off)
    };
    (0..cases.len()).step_by(step).filter(is_warned).count()
}

#[test]
fn indentations_seven_standard_deviations_off_are_told() {
    assert_eq!(warned(7.0, 7), 18);
}

#[test]
fn indentations_five_standard_deviations_off_are_told() {
    let warned = warned(5.0, 2);
    // If each of 60 presses gives a warning with 98 % probability, 55 or fewer warnings have a probability of 0.7 %.
    assert!(warned >= 56, "{warned}");
}

#[test]
fn indentations_half_a_standard_deviation_off_are_not_told() {
    let warned = warned(0.5, 7);
    assert!(warned <= 2, "{warned}");
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
            marker_depth: Some(DEPTH),
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
    let warning = bare["warnings"][0]["text"].as_str().unwrap();
    assert!(
        warning.contains("without a standard deviation: 2 % of it, 0.03 mm"),
        "{warning}"
    );
}
