//! If readings determine a curvature, an estimate is returned. For exact readings, the estimate is exact. Readings of
//! arbitrary bit patterns cause finite results or the expected error.

use nalgebra::Vector2;
use palpate_ep1::{Ep1Error, Estimate, LeastSquares, PadStart, ProbeReading, ReadingNoise};
use palpate_geometry::CurvatureForm;
use proptest::prelude::*;

use crate::{readings, rotated};

/// Any bit pattern of a double, or a number of ordinary magnitude.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        -2.0..2.0_f64,
        proptest::sample::select(&[0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::MAX, 5e-324][..]),
    ]
}

fn reading() -> impl Strategy<Value = ProbeReading> {
    [number(), number(), number(), number()].prop_map(|[x, y, u, v]| ProbeReading {
        rotation: Vector2::new(x, y),
        shift: Vector2::new(u, v),
    })
}

/// The error that must be returned for invalid numbers or too few probes. `None` if the numbers are valid, so that only
/// the fit itself can find an error.
fn expected_error(
    radius: f64,
    noise: &ReadingNoise,
    readings: &[ProbeReading],
) -> Option<Ep1Error> {
    let turns = |reading: &ProbeReading| reading.rotation.iter().all(|angle| angle.is_finite());
    let sizes = [
        noise.relative_rotation_std,
        noise.rotation_std_rad,
        noise.shift_std,
        noise.shift_resolution,
    ];
    let is_size = |size: &f64| *size >= 0.0 && size.is_finite();
    if let Some(probe) = readings.iter().position(|reading| !turns(reading)) {
        Some(Ep1Error::NotFinite { probe })
    } else if !(sizes.iter().all(is_size) && radius > 0.0 && radius.is_finite()) {
        Some(Ep1Error::OutOfRange)
    } else {
        let probes = readings.len();
        (probes < 2).then_some(Ep1Error::TooFewProbes { probes })
    }
}

fn is_finite(estimate: &Estimate) -> bool {
    let form = estimate.curvature;
    let measured = [
        estimate.normal_curvature_u,
        estimate.normal_curvature_v,
        estimate.gaussian_curvature,
        estimate.mean_curvature,
    ];
    (measured.iter().map(|measured| measured.value))
        .chain(measured.iter().filter_map(|measured| measured.std))
        .chain([form.k_uu, form.k_uv, form.k_vv, estimate.arc_length])
        .chain(estimate.amplification(0.3))
        .all(f64::is_finite)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..Default::default() })]

    #[test]
    fn readings_that_determine_the_curvature_have_finite_estimates_with_any_noise(
        radius in (-9.0..9.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        (k_min, spread, angle) in (-0.9..5.0_f64, 0.0..5.0_f64, -3.0..3.0_f64),
        noise in [0.0..1.0_f64, 0.0..1.0, 0.0..1.0, 0.0..1.0],
        (start, theta, probes) in (-3.0..3.0_f64, 0.01..1.0_f64, 2..9),
    ) {
        let form = CurvatureForm { k_uu: k_min / radius, k_uv: 0.0, k_vv: (k_min + spread) / radius };
        let rolls: Vec<_> = (0..probes).map(|probe| (start + f64::from(probe) * 0.7, theta)).collect();
        let noise = ReadingNoise {
            relative_rotation_std: noise[0],
            rotation_std_rad: 0.1 * noise[1] * theta,
            shift_std: noise[2] * radius,
            shift_resolution: noise[3] * radius,
            pad_start: PadStart::PerRoll,
            is_rotation_measured: false,
        };
        let estimate = LeastSquares::of(radius, noise, &readings(radius, &rotated(&form, angle), &rolls));
        prop_assert!(is_finite(&estimate.unwrap()));
    }

    #[test]
    fn any_numbers_return_numbers_or_the_expected_error(
        radius in number(),
        noise in [number(), number(), number(), number()],
        readings in prop::collection::vec(reading(), 0..5),
    ) {
        let noise = ReadingNoise {
            relative_rotation_std: noise[0],
            rotation_std_rad: noise[1],
            shift_std: noise[2],
            shift_resolution: noise[3],
            pad_start: PadStart::PerRoll,
            is_rotation_measured: true,
        };
        for (radius, noise) in [(radius, noise), (1.0, noise), (1.0, ReadingNoise::default())] {
            let found = LeastSquares::of(radius, noise, &readings);
            if let Ok(estimate) = &found {
                let misfits = estimate.misfits(noise, &readings);
                let p_values = misfits.iter().map(|misfit| misfit.p_value());
                let goodness = estimate.goodness(noise, &readings);
                let p_values = p_values.chain(goodness.map(|goodness| goodness.p_value));
                prop_assert!(p_values.into_iter().all(|p_value| (0.0..=1.0).contains(&p_value)), "{misfits:?}");
            }
            if let Some(expected_error) = expected_error(radius, &noise, &readings) {
                prop_assert_eq!(&found, &Err(expected_error));
            }
            prop_assert!(found.is_err() || is_finite(found.as_ref().unwrap()), "{found:?}");
        }
    }

    #[test]
    fn exact_readings_have_exact_estimates(
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
        // The allowed error grows with the object's curvature along u. It is also larger if the object is concave
        // across u (`across` < 0), because errors are then amplified.
        let bound = 1e-14 * (2.0 + along) * (1.0 + along) / (1.0 + across).min(1.0).powi(2) / radius;
        prop_assert!((found.matrix() - form.matrix()).amax() <= bound, "{found:?}, not {form:?}");
    }
}
