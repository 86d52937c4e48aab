//! Compares smoothing splines with those of FITPACK's `surfit` (from SciPy 1.17.1). No maximum number of knots is set,
//! so the data determine the number of knots.

use crate::Status;
use crate::smoothing::{Smoothed, SmoothingSpline, WeightedPoint};

struct Golden {
    points: Vec<WeightedPoint>,
    degree: usize,
    smoothing: f64,
    residual_sum: f64,
    knots: [Vec<f64>; 2],
    coefficients: Vec<f64>,
    grid: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl Golden {
    fn parse(points: &str, spline: &str) -> Self {
        let numbers =
            |line: &str| -> Vec<f64> { line.split(',').map(|one| one.parse().unwrap()).collect() };
        let points = points.lines().skip(1).map(|line| {
            let [u, v, w, weight] = numbers(line).try_into().unwrap();
            WeightedPoint { u, v, w, weight }
        });
        let rows = |key: &str| -> Vec<Vec<f64>> {
            let lines = spline.lines().filter_map(|line| line.split_once(','));
            lines
                .filter(|(name, _)| *name == key)
                .map(|(_, line)| numbers(line))
                .collect()
        };
        let row = |key: &str| rows(key).remove(0);
        Self {
            points: points.collect(),
            degree: row("degree")[0] as usize,
            smoothing: row("smoothing")[0],
            residual_sum: row("residual_sum")[0],
            knots: [row("knots_u"), row("knots_v")],
            coefficients: row("coefficients"),
            grid: row("grid"),
            values: rows("values"),
        }
    }

    fn deviation(&self, smoothed: &Smoothed) -> f64 {
        let mut largest = 0.0_f64;
        for (&u, row) in self.grid.iter().zip(&self.values) {
            for (&v, value) in self.grid.iter().zip(row) {
                largest = largest.max((smoothed.spline.value(u, v) - value).abs());
            }
        }
        largest
    }

    fn knot_deviation(&self, smoothed: &Smoothed) -> f64 {
        let mut largest = 0.0_f64;
        for (knots, expected) in [&smoothed.spline.u, &smoothed.spline.v]
            .into_iter()
            .zip(&self.knots)
        {
            assert_eq!(knots.as_slice().len(), expected.len(), "{knots:?}");
            for (knot, expected) in knots.as_slice().iter().zip(expected) {
                largest = largest.max((knot - expected).abs());
            }
        }
        largest
    }
}

macro_rules! golden {
    ($name:literal) => {
        (
            $name,
            Golden::parse(
                include_str!(concat!("../../tests/fitpack/", $name, ".points.csv")),
                include_str!(concat!("../../tests/fitpack/", $name, ".spline.csv")),
            ),
        )
    };
}

/// Fits a spline to the points of a FITPACK result. The spline must have FITPACK's knots, and its sum of squared
/// residuals must equal the required sum `golden.smoothing` within a thousandth. If FITPACK's own residual sum is
/// required instead, the values of both splines must be equal.
fn assert_agrees(name: &str, golden: &Golden, expected: Status) {
    let spline = SmoothingSpline::new(golden.degree, golden.smoothing);
    let smoothed = spline.fit(&golden.points).unwrap();
    assert_eq!(smoothed.status, expected, "{name}");
    assert_eq!(smoothed.rank, smoothed.spline.coefficients.len(), "{name}");
    let knots = golden.knot_deviation(&smoothed);
    let exact = SmoothingSpline {
        smoothing: golden.residual_sum,
        tolerance: 1e-9,
        ..spline
    };
    let exact = exact.fit(&golden.points).unwrap();
    let at_its_sum = golden.deviation(&exact);
    assert!(knots <= 1e-9, "{name}: knots differ by {knots:e}");
    assert!(golden.knot_deviation(&exact) <= 1e-9, "{name}");
    if expected == Status::Smoothing {
        let miss = smoothed.residual_sum / golden.smoothing - 1.0;
        assert!(miss.abs() <= 1e-3, "{name}: the sum misses by {miss:e}");
    }
    assert!(
        at_its_sum <= 1e-6,
        "{name}: values differ by {at_its_sum:e}"
    );
    let coefficients = exact.spline.coefficients.iter().zip(&golden.coefficients);
    for (one, other) in coefficients {
        assert!((one - other).abs() <= 1e-4, "{name}: {one} against {other}");
    }
}

#[test]
fn splines_are_those_of_fitpack() {
    for ((name, golden), expected) in [
        (golden!("saddle-10pct-biquadratic"), Status::Smoothing),
        (golden!("sphere-5pct-biquadratic"), Status::Polynomial),
        (golden!("turned-cylinder-10pct-bicubic"), Status::Smoothing),
        (golden!("waves-2pct-bicubic"), Status::Smoothing),
        (golden!("waves-5pct-biquadratic"), Status::Smoothing),
        (
            golden!("waves-exact-interpolating-bicubic"),
            Status::Smoothing,
        ),
    ] {
        assert_agrees(name, &golden, expected);
    }
}
