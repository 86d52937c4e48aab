//! Classes of places and their probabilities.

use approx::assert_relative_eq;
use palpate_ep2::{Curvature, SignClass, Uncertainty};
use palpate_geometry::{ShapeClass, ShapeThresholds};

fn curvature(gaussian: f64, mean: f64, stds: [f64; 2], correlation: f64) -> Curvature {
    Curvature {
        gaussian,
        mean,
        uncertainty: Some(Uncertainty {
            gaussian_std: stds[0],
            mean_std: stds[1],
            correlation,
        }),
    }
}

fn probability(curvature: &Curvature, class: ShapeClass) -> f64 {
    let thresholds = ShapeThresholds::new(0.01, 0.05).unwrap();
    curvature.class_probabilities(&thresholds).unwrap()[class as usize]
}

#[test]
fn a_flat_place_is_a_saddle_by_signs_and_no_mean_is_concave() {
    for (gaussian, mean, class) in [
        (5e-324, 1.0, SignClass::Convex),
        (5e-324, -0.0, SignClass::Concave),
        (-0.0, 1.0, SignClass::Saddle),
        (f64::NAN, 1.0, SignClass::Saddle),
    ] {
        assert_eq!(curvature(gaussian, mean, [0.0; 2], 0.0).sign_class(), class);
    }
}

#[test]
fn an_edge_halves_and_errors_apart_multiply() {
    // K is far below its threshold, and H is exactly at its threshold of 0.05. So the classes saddle-ridge and minimal
    // each have the probability ½.
    let on_edge = curvature(-1.0, 0.05, [0.01, 0.002], 0.0);
    assert_relative_eq!(
        probability(&on_edge, ShapeClass::SaddleRidge),
        0.5,
        epsilon = 1e-6
    );
    assert_relative_eq!(
        probability(&on_edge, ShapeClass::Minimal),
        0.5,
        epsilon = 1e-6
    );
    // K and H are each one standard deviation inside the thresholds of the class, and their errors are independent.
    // So the probability of the class is 0.8413².
    let corner = curvature(-0.02, 0.06, [0.01, 0.01], 0.0);
    assert_relative_eq!(
        probability(&corner, ShapeClass::SaddleRidge),
        0.841_344_746_068_542_9_f64.powi(2),
        epsilon = 1e-6
    );
    // The errors of K and H are completely correlated. Let P_K be the probability that K is within its threshold,
    // and P_H the same for H. The probability of the class is the smaller of P_K and P_H, and not their product.
    let tied = curvature(-0.02, 0.06, [0.01, 0.01], -1.0);
    assert_relative_eq!(
        probability(&tied, ShapeClass::SaddleRidge),
        0.841_344_746_068_542_9,
        epsilon = 1e-2
    );
}
