//! Probabilities of shape classes, from certain to anything.

use palpate_ep2::{Curvature, SignClass, Uncertainty};
use palpate_geometry::{ShapeClass, ShapeThresholds};
use palpate_verdict::{Answer, NOT_FINITE, rows};

const PROBABILITIES: &str = "ep2::Curvature::class_probabilities";
const STDS: [f64; 7] = [0.0, f64::from_bits(1), 1e-300, 1e-9, 1.0, 1e9, 1e100];
/// Curvatures of a ridge, a plane, a ball and a saddle, in 1/length.
const CURVATURES: [(f64, f64); 6] = [
    (0.0, 1.0),
    (0.0, 0.0),
    (1.0, 1.0),
    (-1.0, 0.0),
    (1e-300, 1e-150),
    (1e300, 1e150),
];
const SIGNS: [(f64, f64, SignClass); 4] = [
    (f64::from_bits(1), f64::from_bits(1), SignClass::Convex),
    (f64::from_bits(1), -0.0, SignClass::Concave),
    (-0.0, 1e300, SignClass::Saddle),
    (f64::NAN, f64::NAN, SignClass::Saddle),
];

rows! {
    PROBABILITIES, "standard deviations of {std:e}, correlation {correlation}: their sum" => sums(std, correlation),
        for std in STDS, for correlation in [-1.0, 0.0, 1.0];
    PROBABILITIES, "{part} of {number:e}", "none" => told, for number in NOT_FINITE, for (part, told) in with(number);
    PROBABILITIES, "{part} of 1e300: their sum" => told.map(|told| sum(&told)), for (part, told) in with(1e300);
    PROBABILITIES, "{part} of the largest double", "none" => told,
        for (part, told) in with(f64::MAX).into_iter().take(1);
    PROBABILITIES, "{part} of the largest double: their sum" => told.map(|told| sum(&told)),
        for (part, told) in with(f64::MAX).into_iter().skip(1);
    "ep2::Curvature::sign_class", "K {gaussian:e} and H {mean:e}: 1 where it is {name}" =>
        Answer::holds(curvature(gaussian, mean, None).sign_class() == class),
        for (gaussian, mean, class) in SIGNS, for name in [class.name()];
}

const fn curvature(gaussian: f64, mean: f64, uncertainty: Option<Uncertainty>) -> Curvature {
    Curvature {
        gaussian,
        mean,
        uncertainty,
    }
}

type Probabilities = [f64; ShapeClass::ALL.len()];

fn probabilities(
    (gaussian, mean): (f64, f64),
    std: f64,
    correlation: f64,
) -> Option<Probabilities> {
    let uncertainty = Uncertainty {
        gaussian_std: std,
        mean_std: std,
        correlation,
    };
    let thresholds = ShapeThresholds::new(0.01, 0.1).unwrap();
    curvature(gaussian, mean, Some(uncertainty)).class_probabilities(&thresholds)
}

fn sum(told: &Probabilities) -> Answer {
    Answer::near(told.iter().sum(), 1.0)
        .within(1e-12)
        .also(*told)
}

fn sums(std: f64, correlation: f64) -> Option<Answer> {
    let told = CURVATURES.map(|curvatures| probabilities(curvatures, std, correlation));
    let told: Vec<_> = told.into_iter().collect::<Option<_>>()?;
    let sums = told.iter().map(|told| (told.iter().sum(), 1.0));
    Some(
        Answer::all_near(sums)
            .within(1e-12)
            .also(told.iter().copied().flatten()),
    )
}

/// Answer where one number is this.
fn with(number: f64) -> [(&'static str, Option<Probabilities>); 4] {
    [
        (
            "standard deviations",
            probabilities((0.0, 1.0), number, 0.0),
        ),
        ("a correlation", probabilities((0.0, 1.0), 1.0, number)),
        (
            "a Gaussian curvature",
            probabilities((number, 1.0), 1.0, 0.0),
        ),
        ("a mean curvature", probabilities((0.0, number), 1.0, 0.5)),
    ]
}
