//! Scales from 1e-9 to 1e9, ratios from 1e-12 to 1e12, many turns, no turn.

use palpate_geometry::Shape;
use palpate_rolling::{Chart, Model, Motion};
use proptest::prelude::*;

use crate::scenes::{DOP853, dish, paraboloid, plane, roll, saddle, sphere};

#[test]
fn ratios_from_sharp_to_flat() {
    for exponent in -12..=12 {
        let radius = 10.0_f64.powi(exponent);
        for (theta, model) in [(0.1, DOP853), (0.1, Model::ClosedForm), (1e-12, DOP853)] {
            let end = roll(1.0, &sphere(radius), (0.0, 0.0), model, Motion::rolling(0.0, 1.0, theta));
            let truth = theta / (1.0 + 1.0 / radius);
            let off = (end.arc_length / truth - 1.0).abs();
            assert!(off < 1e-11, "R₂ = {radius:e}, θ = {theta:e}, {model:?}: {off:e}");
        }
    }
}

#[test]
fn a_thousand_turns() {
    let theta = 1000.0 * std::f64::consts::TAU;
    let motion = Motion::rolling(0.3, 1.0, theta);
    let model = Model::Dop853 { tolerance: 1e-9, chart: Chart::Free };
    let end = roll(1.0, &plane(), (0.0, 0.0), model, motion);
    assert!((end.arc_length / theta - 1.0).abs() < 1e-9);
    let end = roll(1.0, &sphere(3.0), (0.0, 0.0), Model::ClosedForm, motion);
    assert!((end.arc_length / (0.75 * theta) - 1.0).abs() < 1e-13);
}

#[test]
fn nothing_moves_without_a_motion() {
    for object in [sphere(2.0), paraboloid(1.0), saddle(0.2), dish(4.0)] {
        for motion in [Motion::rolling(0.0, 0.0, 1.0), Motion::rolling(0.0, 1.0, 0.0)] {
            let model = Model::Auto { tolerance: 1e-9, chart: Chart::Free };
            let end = roll(1.0, &object, (0.0, 0.0), model, motion);
            assert_eq!(end.arc_length, 0.0, "{}", object.name());
        }
    }
}

/// A copy of the object with all lengths times `scale`.
fn scaled(scale: f64) -> [Shape; 4] {
    [
        sphere(5.0 * scale),
        paraboloid(0.5 / scale),
        saddle(0.1 / scale),
        dish(3.0 * scale),
    ]
}

proptest! {
    #[test]
    fn scaling_all_lengths_scales_the_roll(
        exponent in -30_i32..30,
        direction in -3.0..3.0_f64,
        theta in 0.001..2.0_f64,
        x in -0.5..0.5_f64,
    ) {
        // By powers of two nothing but the exponents changes.
        let scale = 2.0_f64.powi(exponent);
        let motion = Motion::rolling(direction, 1.0, theta);
        for (unit, object) in scaled(1.0).iter().zip(&scaled(scale)) {
            let reference = roll(1.0, unit, (x, 0.1), DOP853, motion);
            let end = roll(scale, object, (x * scale, 0.1 * scale), DOP853, motion);
            prop_assert_eq!(reference.on_object * scale, end.on_object);
            prop_assert_eq!(reference.on_probe(1.0) * scale, end.on_probe(scale));
        }
    }
}
