//! Estimates from noiseless readings have the true curvature.

use approx::assert_relative_eq;
use nalgebra::Vector2;
use palpate_ep1::{LeastSquares, ProbeReading};
use palpate_geometry::{CurvatureForm, Graph, Shape, Sphere};
use palpate_rolling::{Model, Motion, Roller, Rolls};
use proptest::prelude::*;

use crate::{EXACT, eight, readings, rotated};

proptest! {
    #[test]
    fn probes_that_span_the_plane_determine_any_curvature(
        k_min in -0.9..5.0_f64,
        spread in 0.0..5.0_f64,
        angle in -3.0..3.0_f64,
        rolls in prop::collection::vec((-3.1..3.1_f64, 0.01..0.5_f64), 2..12),
    ) {
        prop_assume!(
            rolls.iter().any(|(a, _)| libm::sin(a - rolls[0].0).abs() > 0.05)
        );
        let form = rotated(&CurvatureForm { k_uu: k_min, k_uv: 0.0, k_vv: k_min + spread }, angle);
        let readings = readings(1.0, &form, &rolls);
        let estimate = LeastSquares::of(1.0, EXACT, &readings).unwrap();
        let scale = 1.0 + form.matrix().norm();
        prop_assert!((estimate.curvature.matrix() - form.matrix()).amax() < 1e-9 * scale);
        prop_assert_eq!(estimate.normal_curvature_u.std, None);
    }
}

#[test]
fn readings_of_a_plane_have_a_curvature_of_exactly_zero() {
    for radius in [10.0, 1.0, 0.3, 7e-9] {
        let readings: Vec<_> = eight(0.1)
            .iter()
            .map(|&(direction, theta)| {
                let motion = Motion::rolling(direction, theta, 1.0);
                let rotation = motion.rotation();
                let shift = Vector2::new(-rotation.y, rotation.x) * radius;
                ProbeReading { rotation, shift }
            })
            .collect();
        let estimate = LeastSquares::of(radius, EXACT, &readings).unwrap();
        assert_eq!(estimate.curvature.k_uu, 0.0);
        assert_eq!(estimate.curvature.k_vv, 0.0);
        assert_eq!(estimate.amplification(0.0), None);
    }
}

fn rolled(object: Shape, theta: f64) -> Vec<ProbeReading> {
    let rolls: Vec<Vec<Motion>> = eight(theta)
        .iter()
        .map(|&(direction, theta)| vec![Motion::rolling(direction, theta, 1.0)])
        .collect();
    let roller = Roller::new(
        Sphere::new(1.0).unwrap(),
        object,
        (0.0, 0.0),
        Model::Meridian,
        Rolls::exact(&rolls),
    )
    .unwrap();
    rolls
        .iter()
        .map(|roll| ProbeReading {
            rotation: roll[0].rotation(),
            shift: roller.shift(roll).unwrap().displacement,
        })
        .collect()
}

#[test]
fn the_error_on_a_paraboloid_matches_the_known_value() {
    // The probe rolls over the arc length s = 0.1 of the paraboloid z = −c r² with c = 1. The roll angle is θ = α +
    // s/R₁, with the slope angle α and the probe's radius R₁. The curvature decreases along the roll, so the estimate
    // is 1.9 % lower than the curvature at the start.
    let theta = 0.296_15;
    let object = Shape::Paraboloid(Graph::paraboloid(1.0).unwrap());
    let estimate = LeastSquares::of(1.0, EXACT, &rolled(object, theta)).unwrap();
    assert_relative_eq!(estimate.arc_length, 0.1, max_relative = 1e-3);
    assert_relative_eq!(1.0 - estimate.curvature.k_uu / 2.0, 0.019, epsilon = 5e-4);
}
