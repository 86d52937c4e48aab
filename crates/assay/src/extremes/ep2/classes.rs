//! Probabilities of shape classes, from certain to anything.

use palpate_ep2::{Curvature, Ep2Error, SignClass, Uncertainty};
use palpate_geometry::{ShapeClass, ShapeThresholds};

use crate::extremes::answer::NONE;
use crate::extremes::{Answer, Case, Outcome};

/// Curvatures of a ridge, a plane, a ball and a saddle, in 1/length.
const CURVATURES: [(f64, f64); 6] = [
    (0.0, 1.0),
    (0.0, 0.0),
    (1.0, 1.0),
    (-1.0, 0.0),
    (1e-300, 1e-150),
    (1e300, 1e150),
];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for std in [0.0, f64::from_bits(1), 1e-300, 1e-9, 1.0, 1e9, 1e100] {
        for correlation in [-1.0, 0.0, 1.0] {
            cases.push(Case::value(
                "ep2::Curvature::class_probabilities",
                format!("standard deviations of {std:e}, correlation {correlation}: their sum"),
                move || sums(std, correlation),
            ));
        }
    }
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, f64::MAX] {
        cases.push(Case::new(
            "ep2::Curvature::class_probabilities",
            format!("standard deviations or curvatures of {number:e}: the sum, or none"),
            move || unsound(number),
        ));
    }
    for (gaussian, mean, class) in [
        (f64::from_bits(1), f64::from_bits(1), SignClass::Convex),
        (f64::from_bits(1), -0.0, SignClass::Concave),
        (-0.0, 1e300, SignClass::Saddle),
        (f64::NAN, f64::NAN, SignClass::Saddle),
    ] {
        cases.push(Case::value(
            "ep2::Curvature::sign_class",
            format!(
                "K {gaussian:e} and H {mean:e}: 1 where it is {}",
                class.name()
            ),
            move || {
                let found = curvature(gaussian, mean, None).sign_class();
                Ok::<_, Ep2Error>(Answer::near(f64::from(u8::from(found == class)), 1.0))
            },
        ));
    }
    cases
}

const fn curvature(gaussian: f64, mean: f64, uncertainty: Option<Uncertainty>) -> Curvature {
    Curvature {
        gaussian,
        mean,
        uncertainty,
    }
}

fn probabilities(
    (gaussian, mean): (f64, f64),
    std: f64,
    correlation: f64,
) -> Result<Option<[f64; ShapeClass::ALL.len()]>, Ep2Error> {
    let uncertainty = Uncertainty {
        gaussian_std: std,
        mean_std: std,
        correlation,
    };
    let thresholds = ShapeThresholds::new(0.01, 0.1).map_err(|_| Ep2Error::OutOfRange)?;
    Ok(curvature(gaussian, mean, Some(uncertainty)).class_probabilities(&thresholds))
}

fn sums(std: f64, correlation: f64) -> Result<Answer, Ep2Error> {
    let mut pairs = Vec::new();
    let mut numbers = Vec::new();
    for curvatures in CURVATURES {
        let found = probabilities(curvatures, std, correlation)?;
        let found = found.unwrap_or([f64::NAN; ShapeClass::ALL.len()]);
        pairs.push((found.iter().sum(), 1.0));
        numbers.extend(found);
    }
    Ok(Answer::all_near(pairs).within(1e-12).also(numbers))
}

/// Whatever is told of sums to 1; none is told of what is no number.
fn unsound(number: f64) -> Outcome {
    let asked = [
        ((0.0, 1.0), number, 0.0),
        ((0.0, 1.0), 1.0, number),
        ((number, 1.0), 1.0, 0.0),
        ((0.0, number), 1.0, 0.5),
    ];
    let told = asked
        .into_iter()
        .filter_map(|(curvatures, std, correlation)| {
            let found = probabilities(curvatures, std, correlation);
            found.expect("thresholds that make sense")
        });
    let sums: Vec<_> = told.map(|told| (told.iter().sum(), 1.0)).collect();
    if sums.is_empty() {
        return Err::<Answer, _>(NONE).into();
    }
    Answer::all_near(sums).within(1e-12).into()
}
