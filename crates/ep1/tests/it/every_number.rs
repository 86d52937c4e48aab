//! Any bit patterns as readings: finite numbers or a named error; exact readings come back exact.

use nalgebra::Vector2;
use palpate_ep1::{LeastSquares, ProbeReading, ReadingNoise};
use palpate_geometry::CurvatureForm;
use proptest::prelude::*;

use crate::readings;

/// Any double at all, or one of everyday size.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        -2.0..2.0_f64,
        Just(0.0),
        Just(-0.0),
    ]
}

fn reading() -> impl Strategy<Value = ProbeReading> {
    [number(), number(), number(), number()].prop_map(|[x, y, u, v]| ProbeReading {
        rotation: Vector2::new(x, y),
        shift: Vector2::new(u, v),
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..Default::default() })]

    #[test]
    fn readings_give_numbers_or_an_error(
        radius in number(),
        noise in [number(), number(), number(), number()],
        readings in prop::collection::vec(reading(), 0..5),
    ) {
        let noise = ReadingNoise {
            relative_rotation_std: noise[0],
            rotation_std_rad: noise[1],
            shift_std: noise[2],
            shift_resolution: noise[3],
        };
        for (radius, noise) in [(radius, noise), (1.0, noise), (1.0, ReadingNoise::default())] {
            let Ok(estimate) = LeastSquares::of(radius, noise, &readings) else { continue };
            let form = estimate.curvature;
            let measured = [
                estimate.normal_curvature_u,
                estimate.normal_curvature_v,
                estimate.gaussian_curvature,
                estimate.mean_curvature,
            ];
            let stds = measured.iter().filter_map(|measured| measured.std);
            let numbers = (measured.iter().map(|measured| measured.value))
                .chain(stds)
                .chain([form.k_uu, form.k_uv, form.k_vv, estimate.arc_length])
                .chain(estimate.amplification(0.3))
                .chain(estimate.mobility().iter().copied());
            prop_assert!({ numbers }.all(f64::is_finite), "{estimate:?}");
        }
    }

    #[test]
    fn exact_readings_are_read_exactly(
        radius in (-9.0..9.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        along in (-9.0..9.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        across in -0.9..3.0_f64,
        start in -3.0..3.0_f64,
        theta in (-9.0..3.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
    ) {
        let form = CurvatureForm { k_uu: along / radius, k_uv: 0.0, k_vv: across / radius };
        let rolls: Vec<_> = (0..8).map(|probe| (start + f64::from(probe) * 0.7, theta)).collect();
        let estimate = LeastSquares::of(radius, ReadingNoise::default(), &readings(radius, &form, &rolls));
        let found = estimate.unwrap().curvature;
        // The stated price for what is flat, the spread of these probes, and a hollow that magnifies.
        let bound = 1e-14 * (2.0 + along) * (1.0 + along) / (1.0 + across).min(1.0).powi(2) / radius;
        prop_assert!((found.matrix() - form.matrix()).amax() <= bound, "{found:?}, not {form:?}");
    }
}
